#pragma once

#include <string>
#include <vector>

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

}  // namespace bodesmith::report
