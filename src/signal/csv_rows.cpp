#include "signal/csv_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "numeric/parallel_for.hpp"

namespace bodesmith {
namespace {

/// A text shorter than this is not worth a thread.
constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

/// Whole lines of the text, and where their rows go.
struct RowPiece {
  const char* begin = nullptr;
  const char* end = nullptr;
  int lines = 0;              ///< line ends within, and a last line without one
  int first_line = 0;         ///< number of its first line
  std::size_t first_row = 0;  ///< place of its first row, were every line one
  std::size_t rows = 0;       ///< found
  const char* stopped = nullptr;
  int stopped_line = 0;
};

class RowReader {
 public:
  RowReader(char separator, std::vector<std::vector<double>>& columns, std::vector<int>& lines)
      : separator_(separator), columns_(columns), lines_(lines) {}

  void read(RowPiece& piece) const {
    const char* p = piece.begin;
    int line = piece.first_line;
    for (; p != piece.end; ++line) {
      const char* const start = p;
      skip_blanks(p, piece.end);
      if (p != piece.end && *p == '#') {
        const void* newline = std::memchr(p, '\n', static_cast<std::size_t>(piece.end - p));
        p = newline == nullptr ? piece.end : static_cast<const char*>(newline);
      } else if (p != piece.end && *p != '\n') {
        if (!read_row(p, piece.end, piece.first_row + piece.rows)) {
          piece.stopped = start;
          piece.stopped_line = line;
          return;
        }
        lines_[piece.first_row + piece.rows++] = line;
      }
      if (p != piece.end) ++p;  // the end of the line
    }
    piece.stopped = p;
    piece.stopped_line = line;
  }

 private:
  void skip_blanks(const char*& p, const char* end) const {
    while (p != end && (*p == ' ' || *p == '\t' || *p == '\r') && *p != separator_) ++p;
  }

  /// Leaves p at the end of the line.
  bool read_row(const char*& p, const char* end, std::size_t row) const {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (c > 0) {
        if (p == end || *p != separator_) return false;
        ++p;
      }
      skip_blanks(p, end);
      if (p != end && *p == '+') ++p;
      double value = 0.0;
      const auto result = std::from_chars(p, end, value);
      if (result.ec != std::errc() || !std::isfinite(value)) return false;
      p = result.ptr;
      skip_blanks(p, end);
      columns_[c][row] = value;
    }
    return p == end || *p == '\n';
  }

  char separator_;
  std::vector<std::vector<double>>& columns_;
  std::vector<int>& lines_;
};

std::vector<RowPiece> pieces_of(std::string_view text) {
  std::vector<RowPiece> out;
  const char* const end = text.data() + text.size();
  for (const char* p = text.data(); p != end;) {
    RowPiece piece;
    piece.begin = p;
    if (static_cast<std::size_t>(end - p) > kPieceBytes) {
      p += kPieceBytes;
      const void* newline = std::memchr(p, '\n', static_cast<std::size_t>(end - p));
      p = newline == nullptr ? end : static_cast<const char*>(newline) + 1;
    } else {
      p = end;
    }
    piece.end = p;
    out.push_back(piece);
  }
  return out;
}

}  // namespace

PlainRows read_plain_rows(std::string_view text, char separator, int first_line,
                          std::vector<std::vector<double>>& columns, std::vector<int>& lines) {
  std::vector<RowPiece> pieces = pieces_of(text);
  const int threads = thread_count(0);
  parallel_for(pieces.size(), threads, [&](std::size_t i) {
    RowPiece& piece = pieces[i];
    piece.lines = static_cast<int>(std::count(piece.begin, piece.end, '\n'));
    if (piece.end[-1] != '\n') ++piece.lines;
  });
  const std::size_t before = lines.size();
  std::size_t rows = before;
  int line = first_line;
  for (RowPiece& piece : pieces) {
    piece.first_line = line;
    piece.first_row = rows;
    line += piece.lines;
    rows += static_cast<std::size_t>(piece.lines);
  }
  lines.resize(rows);
  for (std::vector<double>& column : columns) column.resize(rows);
  const RowReader reader(separator, columns, lines);
  parallel_for(pieces.size(), threads, [&](std::size_t i) { reader.read(pieces[i]); });

  // Close up what comments and blank lines left open, as far as every line was plain.
  PlainRows out;
  std::size_t to = before;
  const auto shift = [&to](auto& values, const RowPiece& piece) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(piece.first_row);
    if (piece.first_row != to)
      std::copy(from, from + static_cast<std::ptrdiff_t>(piece.rows),
                values.begin() + static_cast<std::ptrdiff_t>(to));
  };
  for (const RowPiece& piece : pieces) {
    shift(lines, piece);
    for (std::vector<double>& column : columns) shift(column, piece);
    to += piece.rows;
    out.bytes = static_cast<std::size_t>(piece.stopped - text.data());
    out.lines = piece.stopped_line - first_line;
    if (piece.stopped != piece.end) break;
  }
  lines.resize(to);
  for (std::vector<double>& column : columns) column.resize(to);
  return out;
}

}  // namespace bodesmith
