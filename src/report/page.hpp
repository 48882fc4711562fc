#pragma once

#include <string>
#include <vector>

namespace bodesmith::report {

/// A table of a page. Cells are plain text; `marked` rows are set off (a limit missed, the best choice).
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::size_t> marked;
};

/// A report as one self-contained HTML file: no scripts, no outside styles, fonts or pictures, so it opens offline
/// and prints. Text is plain (escaped here); figures are SVG elements as to_svg() makes them.
class Page {
 public:
  Page(std::string title, std::string subtitle) : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

  /// Starts a chapter; it also becomes an entry of the list at the top.
  void chapter(const std::string& heading);
  void paragraph(const std::string& text);
  /// A note that must not be missed.
  void warning(const std::string& text);
  /// A line with a large figure: "0.0589 %" "worst complex error of the FPAA plan".
  void key_figures(const std::vector<std::pair<std::string, std::string>>& value_and_meaning);
  void table(const Table& table, const std::string& caption = {});
  /// The drawing keeps its own styles and ids (inline_svg.hpp).
  void figure(const std::string& svg, const std::string& caption);
  /// Text in a fixed-width box, e.g. a build sheet.
  void listing(const std::string& text);

  std::string html() const;

 private:
  std::string title_;
  std::string subtitle_;
  struct Chapter {
    std::string heading;
    std::string body;
  };
  std::vector<Chapter> chapters_;
  int figures_ = 0;
  std::string& body();
};

}  // namespace bodesmith::report
