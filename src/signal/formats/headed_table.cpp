// Any table whose headings say what its columns are: CSV with commas, semicolons or tabs, decimal points or commas, a
// line of units below the headings (PicoScope and others).
#include "signal/formats/format.hpp"
#include "signal/formats/table_meaning.hpp"

namespace bodesmith::formats {
namespace {

class HeadedTable : public Format {
 public:
  std::string_view name() const override { return "table with headings"; }
  bool recognises(const Source& source) const override {
    const auto head = table_head(source);
    if (!head) return false;
    const std::vector<Heading> headings = parse_headings(head->headings);
    return has_response_headings(headings) || is_record(source, *head, headings);
  }
  Foreign read(const Source& source) const override {
    return read_by_headings(source, read_table(source), {std::string(name()), {}});
  }
};

}  // namespace

BODESMITH_ENTRY(Format, headed_table, HeadedTable)

}  // namespace bodesmith::formats
