#pragma once
#include <fmt/format.h>

#include <string>
#include <string_view>

namespace pbrt {

inline std::string CountText(int64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace pbrt
