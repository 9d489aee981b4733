#pragma once

#include <cmath>
#include <locale>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

// Checks of numbers on the command line. Their messages state the bounds; those of CLI11 print the
// largest double instead.

namespace cbmv {

/// A validator that accepts a number if `accepts` returns true; `expected` describes valid numbers.
template <typename Number, typename Accepts>
CLI::Validator numberCheck(const Accepts& accepts, const std::string& expected) {
  const auto check = [accepts, expected](const std::string& text) {
    std::istringstream in(text);
    in.imbue(std::locale::classic());
    Number number{};
    const bool is_number = in >> number && in.eof();
    return is_number && accepts(number) ? std::string()
                                        : "is \"" + text + "\", expected " + expected;
  };
  return CLI::Validator(check, "", "number");
}

/// A whole number from `lowest` to `highest`.
inline CLI::Validator wholeNumber(long lowest, long highest = 1000000000) {
  return numberCheck<long>(
      [=](long number) { return number >= lowest && number <= highest; },
      "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
}

/// A number of disparities, or "auto", which becomes 0.
inline CLI::Validator disparityCount() {
  const auto number = numberCheck<long>([](long count) { return count >= 0 && count <= 4096; },
                                        "auto or a whole number from 1 to 4096");
  const auto check = [number](std::string& text) {
    text = text == "auto" ? "0" : text;
    return number(text);
  };
  return CLI::Validator(check, "", "number");
}

/// A finite number that is not negative.
inline CLI::Validator nonNegativeNumber() {
  return numberCheck<double>([](double number) { return number >= 0 && std::isfinite(number); },
                             "a number from 0");
}

/// A finite number above 0.
inline CLI::Validator positiveNumber() {
  return numberCheck<double>([](double number) { return number > 0 && std::isfinite(number); },
                             "a number above 0");
}

}  // namespace cbmv
