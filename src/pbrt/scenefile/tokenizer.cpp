#include "pbrt/scenefile/tokenizer.h"

#include <cctype>
#include <charconv>

namespace pbrt {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

const char *ScanFloat(const char *begin, const char *end, Float *value, bool *overflow) {
    const char *p = begin;
    bool negative = false;
    if (p != end && (*p == '-' || *p == '+')) negative = *p++ == '-';
    if (p == end) return begin;
    // from_chars would also accept a second sign, "inf" and "nan".
    if (!IsDigit(*p) && !(*p == '.' && p + 1 != end && IsDigit(p[1]))) return begin;
    auto format = std::chars_format::general;
    const char *digits = p;
    if (*p == '0' && end - p >= 3 && (p[1] | 0x20) == 'x' &&
        (std::isxdigit(static_cast<unsigned char>(p[2])) || p[2] == '.')) {
        format = std::chars_format::hex;
        digits = p + 2;
    }
    Float magnitude = 0;
    auto [after, error] = std::from_chars(digits, end, magnitude, format);
    if (error == std::errc::invalid_argument) return begin;
    if (error == std::errc::result_out_of_range) {
        magnitude = std::strtof(std::string(p, after).c_str(), nullptr);
        if (magnitude > 1) {
            *overflow = true;
            return after;
        }
    }
    *value = negative ? -magnitude : magnitude;
    return after;
}

const char *ScanInt(const char *begin, const char *end, int *value, bool *overflow) {
    const char *p = begin;
    if (p != end && (*p == '+' || *p == '-')) ++p;
    if (p == end || !IsDigit(*p)) return begin;
    auto [after, error] = std::from_chars(*begin == '+' ? p : begin, end, *value);
    if (error == std::errc::result_out_of_range) *overflow = true;
    return after;
}

}  // namespace pbrt
