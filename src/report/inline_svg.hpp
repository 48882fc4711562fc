#pragma once

#include <string>

namespace bodesmith::report {

/// A drawing to stand in a page beside others: its style rules hold inside it alone, and its ids are its own. The rules
/// of a `<style>` within an `<svg>` would otherwise hold for the whole page, and the first of two equal ids for both.
/// `name` becomes the drawing's id. A drawing without a `<style>` and without ids stays as it is.
std::string inlined_svg(const std::string& svg, const std::string& name);

}  // namespace bodesmith::report
