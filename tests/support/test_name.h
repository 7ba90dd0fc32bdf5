#pragma once
#include <algorithm>
#include <cctype>
#include <string>

namespace pbrt::test {

/// The name of a test: the text with "_" for all but letters and digits.
inline std::string TestName(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char c) { return !std::isalnum(c); }, '_');
    return text;
}

}  // namespace pbrt::test
