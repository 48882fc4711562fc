#include "fpaa/choice_state.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace bodesmith::fpaa {
namespace {

/// Cost of each neper by which a node's gain strays beyond its window, as complex error.
constexpr double kSpreadCost = 0.05;

}  // namespace

ChoiceState::ChoiceState(const CandidateLists& lists, Choice choice)
    : lists_(&lists),
      choice_(std::move(choice)),
      re_(lists.points(), -lists.problem().log_gain),
      im_(lists.points(), 0.0),
      cam_gain_(lists.problem().cam_log_gain.size(), 0.0) {
  const std::vector<std::complex<double>>& others = lists.problem().others;
  for (std::size_t k = 0; k < others.size(); ++k) {
    re_[k] += others[k].real();
    im_[k] += others[k].imag();
  }
  for (std::size_t i = 0; i < choice_.size(); ++i) apply(i, choice_[i], 1.0);
}

void ChoiceState::apply(std::size_t branch, std::size_t candidate, double sign) {
  const Candidate& c = (*lists_)[branch][candidate];
  for (std::size_t k = 0; k < re_.size(); ++k) {
    re_[k] += sign * c.re[k];
    im_[k] += sign * c.im[k];
  }
  cam_gain_[lists_->problem().branches[branch].cam] += sign * c.log_gain;
}

void ChoiceState::replace(std::size_t branch, std::size_t candidate) {
  apply(branch, choice_[branch], -1.0);
  choice_[branch] = candidate;
  apply(branch, candidate, 1.0);
}

double ChoiceState::total_gain() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < choice_.size(); ++i) sum += chosen(i).log_gain;
  return sum;
}

double ChoiceState::residual() const {
  double worst = 0.0;
  for (std::size_t k = 0; k < re_.size(); ++k) worst = std::max(worst, re_[k] * re_[k] + im_[k] * im_[k]);
  return std::sqrt(worst);
}

ChoiceState::Shape ChoiceState::shape() const {
  const auto [low, high] = std::minmax_element(re_.begin(), re_.end());
  const double middle = 0.5 * (*low + *high);
  double worst = 0.0;
  for (std::size_t k = 0; k < re_.size(); ++k) {
    const double re = re_[k] - middle;
    worst = std::max(worst, re * re + im_[k] * im_[k]);
  }
  return {std::sqrt(worst), middle};
}

double ChoiceState::exact_error() const {
  double worst = 0.0;
  for (std::size_t k = 0; k < re_.size(); ++k) {
    worst = std::max(worst, std::abs(std::exp(std::complex<double>(re_[k], im_[k])) - 1.0));
  }
  return worst;
}

double ChoiceState::spread() const {
  const std::vector<double>& wanted = lists_->problem().cam_log_gain;
  double off = 0.0;
  double worst = 0.0;
  for (std::size_t c = 0; c < cam_gain_.size(); ++c) {
    off += cam_gain_[c] - wanted[c];
    worst = std::max(worst, std::abs(off));
  }
  return worst;
}

double ChoiceState::cost() const {
  return residual() + kSpreadCost * std::max(0.0, spread() - lists_->problem().spread_window);
}

double ChoiceState::gain_out_of_reach() const {
  double missing = total_gain() - lists_->problem().log_gain;
  for (const std::size_t i : lists_->finest_first()) {
    const double now = chosen(i).log_gain;
    missing += (*lists_)[i][lists_->nearest_by_gain(i, missing - now)].log_gain - now;
  }
  return std::abs(missing);
}

}  // namespace bodesmith::fpaa
