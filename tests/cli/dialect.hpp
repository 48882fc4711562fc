#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodesmith {

enum class Dialect { ngspice, ltspice, xyce };

/// What a strict reading of a deck by the documented grammar of that simulator, narrowed to the forms that
/// mean the same in all of them, complains about; empty when nothing. Included files are read as well.
///   all      a title first, .end last; R, C: two nodes and a plain number; V: dc, ac, PWL; D: a model;
///            E, G: VALUE={…} of numbers, v(node), + - * /, min, max, tanh, ?: and nothing else (no powers:
///            `^` is exclusive-or in Xyce and |x| in ngspice, no pow, limit, if, table, laplace); X: a
///            subcircuit that is defined, with as many nodes; no suffixes on numbers; names once in every
///            subcircuit; every .subckt closed by an .ends of its name; one analysis a deck
///   ngspice  .control at the end allowed, and only here
///   ltspice  .param, .step param, .save; mc(value,tolerance) of parameters that are set
///   xyce     .include "file", .print ac
std::vector<std::string> dialect_errors(const std::filesystem::path& deck, Dialect dialect);
/// A library: what all three take, without title and analysis.
std::vector<std::string> library_errors(const std::filesystem::path& library);

}  // namespace bodesmith
