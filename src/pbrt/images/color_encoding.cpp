#include <charconv>
#include <cmath>
#include <map>
#include <mutex>

#include "pbrt/images/image.h"

namespace pbrt {

std::optional<ColorEncoding> ColorEncoding::Parse(const std::string &name) {
    if (name == "linear") return ColorEncoding{Kind::Linear, 1};
    if (name == "sRGB") return ColorEncoding{Kind::SRGB, 1};
    const std::string prefix = "gamma ";
    if (!name.starts_with(prefix)) return {};
    size_t begin = name.find_first_not_of(' ', prefix.size());
    if (begin == std::string::npos) return {};
    Float gamma = 0;
    const char *end = name.data() + name.size();
    auto [stop, error] = std::from_chars(name.data() + begin, end, gamma);
    if (error != std::errc() || stop != end || !(gamma > 0) || !std::isfinite(gamma)) return {};
    return ColorEncoding{Kind::Gamma, gamma};
}

Float ColorEncoding::ToLinear(Float encoded) const {
    switch (kind) {
        case Kind::Linear: return encoded;
        case Kind::SRGB:
            return encoded <= Float(0.04045) ? encoded / Float(12.92)
                                             : std::pow((encoded + Float(0.055)) / Float(1.055), Float(2.4));
        case Kind::Gamma: return std::pow(std::max(encoded, Float(0)), gamma);
    }
    return 0;
}

Float ColorEncoding::FromLinear(Float linear) const {
    switch (kind) {
        case Kind::Linear: return linear;
        case Kind::SRGB:
            return linear <= Float(0.0031308) ? linear * Float(12.92)
                                              : Float(1.055) * std::pow(linear, 1 / Float(2.4)) - Float(0.055);
        case Kind::Gamma: return std::pow(std::max(linear, Float(0)), 1 / gamma);
    }
    return 0;
}

ByteCode::ByteCode(const ColorEncoding &encoding) {
    for (size_t i = 0; i < 256; ++i) {
        decode_[i] = encoding.ToLinear(Float(i) / 255);
        limits_[i] = i == 0 ? 0 : encoding.ToLinear((Float(i) - Float(0.5)) / 255);
    }
    limits_[256] = Infinity;
    size_t byte = 0;
    for (size_t i = 0; i < Cells; ++i) {
        while (limits_[byte + 1] <= Float(i) / Cells) ++byte;
        guess_[i] = uint8_t(byte);
    }
}

uint8_t ByteCode::Encode(Float linear) const {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    size_t byte = guess_[size_t(linear * Cells)];
    while (linear >= limits_[byte + 1]) ++byte;
    return uint8_t(byte);
}

const ByteCode &ByteCode::Of(const ColorEncoding &encoding) {
    static std::mutex mutex;
    static std::map<ColorEncoding, ByteCode> codes;
    std::lock_guard lock(mutex);
    return codes.try_emplace(encoding, encoding).first->second;
}

}  // namespace pbrt
