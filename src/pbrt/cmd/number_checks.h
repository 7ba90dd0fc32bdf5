#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pbrt {

/// A validator for option->check(). Unlike CLI11's own, its message does not print the largest double as a bound.
inline CLI::Validator NumberCheck(bool zeroToo, const std::string &name) {
    return CLI::Validator(
        [zeroToo](std::string &text) {
            double v = 0;
            if (!CLI::detail::lexical_cast(text, v)) return "\"" + text + "\" is not a number";
            if (zeroToo ? v >= 0 : v > 0) return std::string();
            return text + (zeroToo ? " is less than 0" : " is not more than 0");
        },
        name);
}

inline const CLI::Validator PositiveNumber = NumberCheck(false, "POSITIVE");
inline const CLI::Validator NonNegativeNumber = NumberCheck(true, "NONNEGATIVE");

}  // namespace pbrt
