#include "synthesis/parts/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "base/whole_number.hpp"

namespace bodesmith::synthesis {
namespace {

// IEC 60063: E3 to E24 are a table (they do not follow the rounded geometric series), the finer ones a
// formula.
const std::vector<double> kE24 = {1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0,
                                  3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2, 9.1};

std::vector<double> every(const std::vector<double>& all, size_t step) {
  std::vector<double> out;
  for (size_t i = 0; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

std::vector<double> geometric(int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) {
    const double exact = std::pow(10.0, static_cast<double>(i) / count);
    out.push_back(std::round(exact * 100.0) / 100.0);
    if (count == 192 && i == 185) out.back() = 9.20;  // the standard's one departure from the formula (9.19)
  }
  return out;
}

/// mantissa * 10^decade as the decimal number that a person would write, not a product's rounding.
class Decade {
 public:
  explicit Decade(int decade)
      : up_(decade >= 2), power_(std::pow(10.0, static_cast<double>(std::abs(decade - 2)))) {}
  double value(double mantissa) const {
    const auto hundredths = static_cast<double>(nearest_whole<long>(mantissa * 100.0));
    return up_ ? hundredths * power_ : hundredths / power_;
  }

 private:
  bool up_;
  double power_;
};

}  // namespace

Series Series::named(std::string_view name) {
  Series out;
  out.name_ = name;
  if (name == "E3") {
    out.mantissas_ = every(kE24, 8);
  } else if (name == "E6") {
    out.mantissas_ = every(kE24, 4);
  } else if (name == "E12") {
    out.mantissas_ = every(kE24, 2);
  } else if (name == "E24") {
    out.mantissas_ = kE24;
  } else if (name == "E48") {
    out.mantissas_ = geometric(48);
  } else if (name == "E96") {
    out.mantissas_ = geometric(96);
  } else if (name == "E192") {
    out.mantissas_ = geometric(192);
  } else if (name != "exact") {
    throw InputError(fmt::format(
        "'{}' is not a series of parts, expected E3, E6, E12, E24, E48, E96, E192 or exact", name));
  }
  return out;
}

Series Series::stock(std::string name, std::vector<double> values) {
  if (values.empty())
    throw InputError(fmt::format("the stock list '{}' is empty, expected at least one value", name));
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw InputError(fmt::format("the stock list '{}' holds {}, expected values above 0", name, value));
    }
  }
  Series out;
  out.name_ = std::move(name);
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  out.stock_ = std::move(values);
  return out;
}

std::vector<double> Series::values(double low, double high) const {
  std::vector<double> out;
  // A value typed as a limit is itself allowed, whatever its last bit.
  const double least = low * (1.0 - 1e-9);
  const double most = high * (1.0 + 1e-9);
  for (const double value : stock_) {
    if (value >= least && value <= most) out.push_back(value);
  }
  if (mantissas_.empty() || !(low > 0.0) || high < low) return out;
  const int last = whole_number(std::floor(std::log10(most)), -400, 400);
  for (int decade = whole_number(std::floor(std::log10(least)), -400, 400); decade <= last; ++decade) {
    const Decade of(decade);
    for (const double mantissa : mantissas_) {
      const double value = of.value(mantissa);
      if (value >= least && value <= most) out.push_back(value);
    }
  }
  return out;
}

double Series::nearest_above(double value) const {
  const double out = nearest(value);
  if (out >= value) return out;
  for (const double above : values(value, 2.5 * value)) {  // E3 has gaps of a factor 2.2
    if (above >= value) return above;
  }
  return out;
}

double Series::nearest(double value) const {
  return nearest(value, 1).front();
}

std::vector<double> Series::nearest(double value, int count) const {
  if (is_exact()) return {value};
  if (!(value > 0.0) || !std::isfinite(value))
    throw std::logic_error(fmt::format("a part of {} was to be rounded to {}", value, name_));
  std::vector<double> all = stock_;
  const double finest = mantissas_.size() >= 48 ? 1.0 + 0.08 * count : 10.0;
  for (double width = finest; all.empty() || (stock_.empty() && static_cast<int>(all.size()) < 2 * count);
       width *= 2.0) {
    all = values(value / width, value * width);
  }
  const auto distance = [&](double v) { return std::abs(std::log(v / value)); };
  std::ranges::stable_sort(all, [&](double a, double b) { return distance(a) < distance(b); });
  if (static_cast<int>(all.size()) > count) all.resize(static_cast<size_t>(count));
  return all;
}

}  // namespace bodesmith::synthesis
