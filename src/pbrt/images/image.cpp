#include "pbrt/images/image.h"

#include <Imath/half.h>

#include <charconv>
#include <cmath>
#include <mutex>

#include "pbrt/core/memory.h"

namespace pbrt {
namespace {

int PositiveModulo(int a, int n) {
    int r = a % n;
    return r < 0 ? r + n : r;
}

// Folds `along` into the octahedral square; mirrors `across` where an edge is crossed.
void FoldOctahedral(int &along, int &across, int size, int acrossSize) {
    if (along < -size || along >= 2 * size) along = PositiveModulo(along, 2 * size);
    if (along < 0) along = std::min(-along, size - 1);
    else if (along >= size) along = 2 * size - 1 - along;
    else return;
    across = acrossSize - 1 - across;
}

size_t ValueBytes(PixelFormat format) {
    return format == PixelFormat::U8 ? 1 : format == PixelFormat::Half ? sizeof(uint16_t) : sizeof(float);
}

}  // namespace

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

bool RemapPixel(Point2i &p, Point2i resolution, WrapMode wrap) {
    if (p.x >= 0 && p.y >= 0 && p.x < resolution.x && p.y < resolution.y) return true;
    switch (wrap) {
        case WrapMode::Black: return false;
        case WrapMode::Repeat: p = {PositiveModulo(p.x, resolution.x), PositiveModulo(p.y, resolution.y)}; return true;
        case WrapMode::Clamp: p = glm::clamp(p, Point2i(0), resolution - 1); return true;
        case WrapMode::OctahedralSphere:
            p = glm::clamp(p, Point2i(-(1 << 28)), Point2i(1 << 28));
            FoldOctahedral(p.x, p.y, resolution.x, resolution.y);
            FoldOctahedral(p.y, p.x, resolution.y, resolution.x);
            return true;
    }
    return false;
}

Image::Image(PixelFormat format, Point2i resolution, std::vector<std::string> channels, ColorEncoding encoding)
    : format_(format), resolution_(resolution), channels_(std::move(channels)), encoding_(encoding) {
    PBRT_CHECK_MSG(resolution.x > 0 && resolution.y > 0 && !channels_.empty(), "{} x {}, {} channels", resolution.x,
                   resolution.y, channels_.size());
    RequireMemory(double(ValueCount() * ValueBytes(format_)),
                  fmt::format("an image of {} x {} pixels", resolution.x, resolution.y), {});
    data_.resize(ValueCount() * ValueBytes(format_));
    if (format_ == PixelFormat::U8) code_ = &ByteCode::Of(encoding_);
}

Float Image::Get(Point2i p, int channel) const {
    size_t i = Index(p, channel);
    switch (format_) {
        case PixelFormat::U8: return code_->Decode(As<uint8_t>()[i]);
        case PixelFormat::Half: return imath_half_to_float(As<uint16_t>()[i]);
        case PixelFormat::Float: return As<float>()[i];
    }
    return 0;
}

void Image::Set(Point2i p, int channel, Float linear) {
    size_t i = Index(p, channel);
    switch (format_) {
        case PixelFormat::U8: static_cast<uint8_t *>(Data())[i] = code_->Encode(linear); break;
        case PixelFormat::Half:
            static_cast<uint16_t *>(Data())[i] = imath_float_to_half(std::clamp(linear, -kMaxHalf, kMaxHalf));
            break;
        case PixelFormat::Float: static_cast<float *>(Data())[i] = linear; break;
    }
}

Float Image::Bilinear(Point2 st, int channel, WrapMode wrap) const {
    Float x = st.x * Float(resolution_.x) - Float(0.5);
    Float y = st.y * Float(resolution_.y) - Float(0.5);
    Float fx = std::floor(x), fy = std::floor(y);
    Point2i p(int(std::clamp(fx, Float(-1e9), Float(1e9))), int(std::clamp(fy, Float(-1e9), Float(1e9))));
    Float dx = x - fx, dy = y - fy;
    Float top = Lerp(dx, Get(p, channel, wrap), Get(p + Point2i(1, 0), channel, wrap));
    Float bottom = Lerp(dx, Get(p + Point2i(0, 1), channel, wrap), Get(p + Point2i(1, 1), channel, wrap));
    return Lerp(dy, top, bottom);
}

Image Image::Extract(const std::vector<std::string> &channels, const std::string &name) const {
    std::vector<size_t> from;
    for (const std::string &channel : channels) {
        int index = FindChannel(channel);
        if (index < 0) throw UserError("{} has no channel \"{}\"; {}", name, channel, ListChoices(channel, channels_));
        from.push_back(index);
    }
    Image result(format_, resolution_, channels, encoding_);
    auto copy = [&]<class T>(const T *source) {
        T *target = static_cast<T *>(result.Data());
        for (size_t i = 0; i < ValueCount(); i += channels_.size())
            for (size_t c : from) *target++ = source[i + c];
    };
    if (format_ == PixelFormat::U8) copy(As<uint8_t>());
    else if (format_ == PixelFormat::Half) copy(As<uint16_t>());
    else copy(As<float>());
    return result;
}

Image Image::ConvertTo(PixelFormat format) const {
    if (format == format_) return *this;
    Image result(format, resolution_, channels_, encoding_);
    ForEachValue(*this, [&](Point2i p, int c) { result.Set(p, c, Get(p, c)); });
    return result;
}

Image Image::Crop(const Bounds2i &bounds) const {
    PBRT_CHECK_MSG(!bounds.IsEmpty() && bounds.low.x >= 0 && bounds.low.y >= 0 && bounds.high.x <= resolution_.x &&
                       bounds.high.y <= resolution_.y,
                   "[{}, {}) x [{}, {}) of {} x {}", bounds.low.x, bounds.high.x, bounds.low.y, bounds.high.y,
                   resolution_.x, resolution_.y);
    Image result(format_, {bounds.Width(), bounds.Height()}, channels_, encoding_);
    const size_t rowBytes = result.Bytes() / bounds.Height();
    auto target = result.data_.begin();
    for (int y = bounds.low.y; y < bounds.high.y; ++y)
        target = std::copy_n(&data_[Index({bounds.low.x, y}, 0) * ValueBytes(format_)], rowBytes, target);
    return result;
}

}  // namespace pbrt
