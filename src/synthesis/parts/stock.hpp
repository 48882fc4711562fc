#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "base/provenance.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {

/// The parts that are at hand, and within which limits they may be used. What a list does not say stays as
/// it was.
///
/// TOML, `bodesmith.stock/1`:
///   schema = "bodesmith.stock/1"
///   [resistors]
///   values_ohm = [1e3, 2.2e3, 4.7e3]    # or: series = "E24"
///   least_ohm = 1e3                      # limits, optional
///   greatest_ohm = 1e6
///   [capacitors]
///   values_f = [1e-9, 10e-9]             # or: series = "E6"
///   least_f = 100e-12
///   greatest_f = 100e-9
/// CSV: columns resistance_ohm and capacitance_f (or one of them), in every row one of the two cells:
///   resistance_ohm,capacitance_f
///   4700,
///   ,1e-8
struct StockList {
  std::optional<Series> resistors;
  std::optional<Series> capacitors;
  std::optional<double> min_ohm, max_ohm, min_f, max_f;

  /// By extension: .csv, otherwise TOML. Errors name file and line.
  static StockList read(const std::filesystem::path& path, Provenance& from);
  static StockList parse_csv(std::string_view text, const std::string& file);
  static StockList parse_toml(std::string_view text, const std::string& file);

  void apply_to(RealiseOptions& options) const;
};

}  // namespace bodesmith::synthesis
