#include <string>

#include "base/document.hpp"
#include "base/document_tree.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Branch = std::shared_ptr<const Node::Data>;

/// `at` with `value` under the dotted `key`; without that member when `value` is null. `blame` is where the change
/// stands, which new tables are said to stand in.
Branch changed(const Branch& at, std::string_view key, const Branch& value, const Branch& blame) {
  const auto copy = at ? std::make_shared<Node::Data>(*at) : std::make_shared<Node::Data>();
  if (!at) {
    copy->kind = Node::Kind::object;
    copy->line = blame->line;
    copy->file = blame->file;
  }
  const std::size_t dot = key.find('.');
  const std::string head(key.substr(0, dot));
  if (copy->kind != Node::Kind::object || head.empty())
    throw InputError(
        *blame->file, blame->line,
        "'" + std::string(key) + "' is no place in the document, expected a key of a table in it");
  auto member = copy->members.begin();
  while (member != copy->members.end() && member->first != head) ++member;
  const Branch old = member == copy->members.end() ? nullptr : member->second;
  if (!old && !value)
    throw InputError(*blame->file, blame->line,
                     "'" + head + "' is not in the document, so cannot be removed");
  const Branch put = dot == std::string_view::npos ? value : changed(old, key.substr(dot + 1), value, blame);
  if (!put) {
    copy->members.erase(member);
  } else if (old) {
    member->second = put;
  } else {
    copy->members.emplace_back(head, put);
  }
  return copy;
}

}  // namespace

Node Node::with(std::string_view key, const Node& value) const {
  return Node(changed(data_, key, value.data_, value.data_), place_);
}

Node Node::without(std::string_view key, const Node& blame) const {
  return Node(changed(data_, key, nullptr, blame.data_), place_);
}

}  // namespace bodesmith
