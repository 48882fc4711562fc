#include "hysteresis/preisach.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"

namespace bodesmith::hysteresis {

EverettTable EverettTable::from_weights(double u_min, double u_max, std::size_t levels,
                                        const std::vector<double>& w) {
  EverettTable out;
  out.u_min = u_min;
  out.u_max = u_max;
  out.levels = levels;
  const std::size_t stride = levels + 1;
  out.values.assign(stride * stride, 0.0);
  // T(a, b) = T(a − 1, b) + Σ_{b ≤ j < a} w(a − 1, j), the sum taken from the right.
  for (std::size_t a = 1; a <= levels; ++a) {
    const double* row = w.data() + a * (a - 1) / 2;
    double sum = 0.0;
    for (std::size_t b = a; b-- > 0;) {
      sum += row[b];
      out.values[a * stride + b] = out.values[(a - 1) * stride + b] + sum;
    }
  }
  for (std::size_t a = 0; a <= levels; ++a)
    for (std::size_t b = a + 1; b <= levels; ++b) out.values[a * stride + b] = -out.values[b * stride + a];
  return out;
}

double BilinearEverett::input(const Turn& from, const Turn* toward, int direction, double y,
                              double now) const {
  const std::ptrdiff_t stride = cells_ + 1;
  const double t = from.cache.fraction;
  if (direction > 0) {
    // v(a) = T(n_a, from) rises with a: the first cell whose upper node reaches the target.
    const double target = y - from.y;
    const double* column = data_ + from.cache.cell;
    const auto at = [&](int a) {
      const double* p = column + a * stride;
      return p[0] + t * (p[1] - p[0]);
    };
    int low = cache(now).cell;  // the gain at this node is below the target
    int high = toward != nullptr ? toward->cache.cell : cells_ - 1;
    while (low < high) {
      const int middle = (low + high) >> 1;
      if (at(middle + 1) >= target) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    const double below = at(low);
    const double above = at(low + 1);
    const double fraction = above > below ? (target - below) / (above - below) : 1.0;
    return std::max(now, u_min_ + (low + std::min(fraction, 1.0)) * step_);
  }
  const double target = from.y - y;  // T(from, n_b) rises as b falls
  const double* row = data_ + from.cache.cell * stride;
  const auto at = [&](int b) { return row[b] + t * (row[b + stride] - row[b]); };
  int high = cache(now).cell;
  int low = toward != nullptr ? toward->cache.cell : 0;
  while (low < high) {
    const int middle = (low + high + 1) >> 1;
    if (at(middle) >= target) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  const double below = at(low);  // the larger one
  const double above = at(low + 1);
  const double fraction = below > above ? (below - target) / (below - above) : 0.0;
  return std::min(now, u_min_ + (low + std::clamp(fraction, 0.0, 1.0)) * step_);
}

RelayEverett::RelayEverett(std::shared_ptr<const EverettTable> table) : table_(std::move(table)) {}

RelayEverett::Cache RelayEverett::cache(double u) const {
  const double x =
      (u - table_->u_min) * static_cast<double>(table_->levels) / (table_->u_max - table_->u_min);
  if (!(x > 0.0)) return 0;
  const auto levels = static_cast<double>(table_->levels);
  if (x >= levels) return 2 * static_cast<int>(table_->levels);
  const double node = std::floor(x);
  return 2 * static_cast<int>(node) + (x > node ? 1 : 0);
}

double RelayEverett::output(const Turn& from, const Turn*, int direction, double u) const {
  const Cache here = cache(u);
  // Up-switching at nodes reached from below (rounded down), down-switching at nodes reached from above
  // (rounded up).
  const Cache high = direction > 0 ? here : from.cache;
  const Cache low = direction > 0 ? from.cache : here;
  const int a = high / 2;
  const int b = (low + 1) / 2;
  if (b >= a) return from.y;
  const double gain = table_->at(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
  return direction > 0 ? from.y + gain : from.y - gain;
}

EverettTable EverettTable::from_parameters(const Parameters& values, const char* weights) {
  const double u_min = values.number("u_min");
  const double u_max = values.number("u_max");
  if (!(u_max > u_min)) throw DesignError("u_max is not above u_min");
  const std::vector<double>& w = values.list(weights);
  const auto levels =
      nearest_whole<std::size_t>((std::sqrt(8.0 * static_cast<double>(w.size()) + 1.0) - 1.0) / 2.0);
  if (w.empty() || levels * (levels + 1) / 2 != w.size())
    throw DesignError(fmt::format("{} has {} numbers, expected L (L + 1)/2 for L levels", weights, w.size()));
  return from_weights(u_min, u_max, levels, w);
}

Preisach Preisach::from(const Parameters& values) {
  return {.table = std::make_shared<const EverettTable>(EverettTable::from_parameters(values, "w")),
          .offset = values.number("offset"),
          .bilinear = values.word("interpolation") == "bilinear"};
}

namespace {

class PreisachType final : public ShapedModelType<Preisach> {
 public:
  PreisachType()
      : ShapedModelType(
            "preisach",
            "weighted relays by a stack of turning points and the Everett function; exact inverse",
            {
                any_number("u_min", "u", "lower end of the input range: all relays off"),
                any_number("u_max", "u", "upper end of the input range: all relays on"),
                list_of(not_negative(
                    "w", "y", "weights of the relays, L (L + 1)/2 of them: (0,0), (1,0), (1,1), (2,0), …")),
                any_number("offset", "y", "output with all relays off").with_default(0.0),
                one_word_of("interpolation", "how a relay's weight is spread", {"bilinear", "relays"}),
            }) {}

 protected:
  std::unique_ptr<Operator> operator_of(const Preisach& model) const override {
    if (model.bilinear)
      return std::make_unique<EverettOperator<BilinearEverett>>(BilinearEverett(model.table),
                                                                model.table->u_min, model.offset);
    return std::make_unique<EverettOperator<RelayEverett>>(RelayEverett(model.table), model.table->u_min,
                                                           model.offset);
  }
  std::unique_ptr<Inverse> inverse_of(const Preisach& model) const override {
    if (!model.bilinear)
      throw DesignError("relays make a staircase, which has no inverse; use interpolation = \"bilinear\"");
    const EverettTable& table = *model.table;
    using Op = EverettOperator<BilinearEverett>;
    return std::make_unique<EverettInverse<BilinearEverett>>(
        Op(BilinearEverett(model.table), table.u_min, model.offset), table.u_min, model.offset,
        model.offset + table.at(table.levels, 0));
  }
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_preisach(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, preisach_type, PreisachType)

}  // namespace bodesmith::hysteresis
