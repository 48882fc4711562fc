#include "report/thin.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bodesmith::report {

Series thinned(Series series, std::size_t most) {
  const std::size_t n = std::min(series.x.size(), series.y.size());
  if (n <= most) return series;
  const std::size_t cells = std::max<std::size_t>(1, most / 2);
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t c = 0; c < cells; ++c) {
    const std::size_t from = c * n / cells;
    const std::size_t to = (c + 1) * n / cells;
    std::array<std::size_t, 3> kept{to, to, to};  // lowest, highest, gap
    for (std::size_t i = from; i < to; ++i) {
      if (!std::isfinite(series.y[i]) || !std::isfinite(series.x[i])) {
        kept[2] = i;
        continue;
      }
      if (kept[0] == to || series.y[i] < series.y[kept[0]]) kept[0] = i;
      if (kept[1] == to || series.y[i] > series.y[kept[1]]) kept[1] = i;
    }
    std::sort(kept.begin(), kept.end());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (kept[k] == to || (k > 0 && kept[k] == kept[k - 1])) continue;
      x.push_back(series.x[kept[k]]);
      y.push_back(series.y[kept[k]]);
    }
  }
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

}  // namespace bodesmith::report
