#include <fmt/format.h>

#include <algorithm>

#include "base/documents/document_tree.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Data = Node::Data;

/// Where the parser reads. It hands characters on and counts lines; the parser looks one character ahead
/// after a number, so the line of a value is that of the last character which was not white space.
struct Cursor {
  const char* next;
  const char* end;
  int line = 1;
  int value_line = 1;
};

class CountingIterator {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = char;
  using pointer = const char*;
  using reference = const char&;
  using iterator_category = std::input_iterator_tag;

  CountingIterator(Cursor* cursor, const char* at) : cursor_(cursor), at_(at) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') {
      ++cursor_->line;
    } else if (*at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != ',' && *at_ != ']' && *at_ != '}') {
      cursor_->value_line = cursor_->line;
    }
    ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator old = *this;
    ++*this;
    return old;
  }
  friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }
  friend bool operator!=(const CountingIterator& a, const CountingIterator& b) { return a.at_ != b.at_; }

 private:
  Cursor* cursor_;
  const char* at_;
};

/// Builds the tree from parser events.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(Cursor& cursor, std::shared_ptr<const std::string> file)
      : cursor_(cursor), file_(std::move(file)) {}

  bool null() override { return put(make(Node::Kind::null)); }
  bool boolean(bool value) override {
    auto data = make(Node::Kind::boolean);
    data->boolean = value;
    return put(data);
  }
  bool number_integer(number_integer_t value) override { return put_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return put_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return put_number(value); }
  bool string(string_t& value) override {
    auto data = make(Node::Kind::string);
    data->string = value;
    return put(data);
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Node::Kind::object); }
  bool start_array(std::size_t) override { return open(Node::Kind::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    for (const auto& member : stack_.back()->members) {
      if (member.first == name) {
        throw InputError(*file_, cursor_.value_line, fmt::format("'{}' is given twice", name));
      }
    }
    keys_.back() = name;
    return true;
  }
  bool parse_error(std::size_t, const std::string& token, const nlohmann::detail::exception& error) override {
    std::string what = error.what();
    // "[json.exception.parse_error.101] parse error at line 3, column 2: syntax error while ..." -> the last
    // part
    // (or "[json.exception.out_of_range.406] number overflow parsing '1e999'").
    if (const std::size_t cut = what.find(": "); cut != std::string::npos) {
      what = what.substr(cut + 2);
    } else if (what.starts_with('[')) {
      what = what.substr(std::min(what.find("] ") + 2, what.size()));
    }
    if (what.size() > 200) what = what.substr(0, 200) + "...";
    (void)token;
    throw InputError(*file_, cursor_.line, "not valid JSON: " + what);
  }

  std::shared_ptr<const Data> root() const { return root_; }

 private:
  std::shared_ptr<Data> make(Node::Kind kind) {
    auto data = std::make_shared<Data>();
    data->kind = kind;
    data->line = cursor_.value_line;
    data->file = file_;
    return data;
  }
  bool put_number(double value) {
    auto data = make(Node::Kind::number);
    data->number = value;
    return put(data);
  }
  bool put(const std::shared_ptr<Data>& data) {
    if (stack_.empty()) {
      root_ = data;
    } else if (stack_.back()->kind == Node::Kind::array) {
      stack_.back()->items.push_back(data);
    } else {
      stack_.back()->members.emplace_back(keys_.back(), data);
    }
    return true;
  }
  bool open(Node::Kind kind) {
    if (stack_.size() > 200) throw InputError(*file_, cursor_.line, "nested more than 200 deep");
    auto data = make(kind);
    put(data);
    stack_.push_back(data);
    keys_.emplace_back();
    return true;
  }
  bool close() {
    stack_.pop_back();
    keys_.pop_back();
    return true;
  }

  Cursor& cursor_;
  std::shared_ptr<const std::string> file_;
  std::shared_ptr<const Data> root_;
  std::vector<std::shared_ptr<Data>> stack_;
  std::vector<std::string> keys_;
};

}  // namespace

Node parse_json(std::string_view text, const std::string& file) {
  require_utf8(text, file);
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  Cursor cursor{text.data(), text.data() + text.size()};
  Builder builder(cursor, std::make_shared<const std::string>(file));
  Json::sax_parse(CountingIterator(&cursor, cursor.next), CountingIterator(&cursor, cursor.end), &builder);
  return Node(builder.root(), "");
}

}  // namespace bodesmith
