#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report/plot.hpp"
#include "report/script_data.hpp"

namespace bodesmith::report {

/// The page's one script: uPlot with its licence (templates/vendor/uPlot/), and this program's own (templates/report/live/),
/// in a scope of their own.
std::string page_script();

/// The page's style sheet: uPlot's and its own.
std::string page_style();

/// A Content-Security-Policy under which nothing but these scripts and style sheets holds, named by their SHA-256, and the
/// page asks no one for anything.
std::string content_policy(const std::vector<std::string>& scripts, const std::vector<std::string>& styles);

/// What stands in the `<style>` elements of a drawing.
std::vector<std::string> styles_in(const std::string& svg);

/// A report as one self-contained HTML file: no outside scripts, styles, fonts or pictures, so it opens offline. Its plots
/// are live where scripts run (docs/report.md) and drawings where they do not, or on paper. Text is plain (escaped here).
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
  /// The drawing keeps its own styles and ids.
  void figure(const std::string& svg, const std::string& caption);
  /// Plots below one another.
  void plots(const std::vector<Plot>& plots, const std::string& caption);
  /// A table of which a row can be chosen, one for each choice; `chosen` is shown first. Without scripts the table stands
  /// alone.
  void choices(const Table& table, const std::string& caption, const std::vector<Choice>& choices,
               std::size_t chosen);
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
  std::vector<std::string> styles_;  ///< of the drawings
  std::string& body();
  std::string drawing(const std::string& svg);
};

}  // namespace bodesmith::report
