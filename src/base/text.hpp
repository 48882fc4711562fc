#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bodesmith {

/// Shortest decimal text that reads back as exactly the same double ("1.0" style for whole numbers).
std::string number_text(double value);

/// `value` with `digits` significant digits and no superfluous zeros: 0.0163, 1.5e+09.
std::string rounded_text(double value, int digits = 4);

/// With the prefix that engineers write: engineering_text(20500, "Ω") is "20.5 kΩ", engineering_text(1e-8,
/// "F") "10 nF".
std::string engineering_text(double value, std::string_view unit, int digits = 3);

/// Pieces between separators; "a,,b" has three.
std::vector<std::string_view> split(std::string_view text, char separator);
std::string_view trim(std::string_view text);
/// Lines of more than 100 characters broken at blanks; the rest is indented by two more than the line, or than what
/// stands behind its label ("target     points.csv").
std::string folded_text(std::string_view text);
std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// Reads one number that fills the whole text. False when it does not, or is not finite. Ignores the locale.
bool parse_number(std::string_view text, double& value);

}  // namespace bodesmith
