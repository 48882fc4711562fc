#include "schematic/series_parallel.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace bodesmith::schematic {
namespace {

void put(Branch::Kind kind, Branch child, std::vector<Branch>& into) {
  if (child.kind == kind) {
    for (Branch& one : child.children) into.push_back(std::move(one));
  } else {
    into.push_back(std::move(child));
  }
}

Branch merged(Branch::Kind kind, Branch a, Branch b) {
  Branch out;
  out.kind = kind;
  out.left = a.left;
  out.right = b.right;
  put(kind, std::move(a), out.children);
  put(kind, std::move(b), out.children);
  // What is drawn lowest comes first: single parts below ladders.
  if (kind == Branch::Kind::parallel) {
    std::ranges::stable_sort(out.children, [](const Branch& x, const Branch& y) {
      return x.kind == Branch::Kind::part && y.kind != Branch::Kind::part;
    });
  }
  return out;
}

bool merge_parallel(std::vector<Branch>& all) {
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = i + 1; j < all.size(); ++j) {
      if (!all[i].joins(all[j].left, all[j].right)) continue;
      all[i] = merged(Branch::Kind::parallel, all[i], all[j].from(all[i].left));
      all.erase(all.begin() + static_cast<std::ptrdiff_t>(j));
      return true;
    }
  }
  return false;
}

bool merge_series(std::vector<Branch>& all, const std::set<std::string>& kept) {
  std::map<std::string, std::vector<size_t>> at;
  for (size_t i = 0; i < all.size(); ++i) {
    at[all[i].left].push_back(i);
    at[all[i].right].push_back(i);
  }
  for (const auto& [node, here] : at) {
    if (kept.contains(node) || here.size() != 2 || here[0] == here[1]) continue;
    const size_t i = here[0], j = here[1];
    all[i] = merged(Branch::Kind::series, all[i].from(all[i].other_end(node)), all[j].from(node));
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(j));
    return true;
  }
  return false;
}

}  // namespace

Branch Branch::from(const std::string& node) const {
  if (left == node) return *this;
  Branch out = *this;
  std::swap(out.left, out.right);
  if (kind == Kind::series) std::ranges::reverse(out.children);
  for (Branch& child : out.children) child = child.from(child.right);
  return out;
}

std::vector<Branch> series_parallel_branches(const std::vector<Part>& parts,
                                             const std::set<std::string>& kept) {
  std::vector<Branch> all;
  for (size_t i = 0; i < parts.size(); ++i) {
    Branch one;
    one.part = i;
    one.left = parts[i].from;
    one.right = parts[i].to;
    all.push_back(std::move(one));
  }
  while (merge_parallel(all) || merge_series(all, kept)) {
  }
  return all;
}

}  // namespace bodesmith::schematic
