#include "pbrt/images/image.h"

#include <Imath/half.h>

#include <cstring>

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

}  // namespace

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
    switch (format_) {
        case PixelFormat::U8:
            u8_.resize(ValueCount());
            code_ = &ByteCode::Of(encoding_);
            break;
        case PixelFormat::Half: half_.resize(ValueCount()); break;
        case PixelFormat::Float: float_.resize(ValueCount()); break;
    }
}

int Image::FindChannel(const std::string &name) const {
    for (size_t i = 0; i < channels_.size(); ++i)
        if (channels_[i] == name) return int(i);
    return -1;
}

Float Image::Get(Point2i p, int channel) const {
    size_t i = Index(p, channel);
    switch (format_) {
        case PixelFormat::U8: return code_->Decode(u8_[i]);
        case PixelFormat::Half: return imath_half_to_float(half_[i]);
        case PixelFormat::Float: return float_[i];
    }
    return 0;
}

Float Image::Get(Point2i p, int channel, WrapMode wrap) const {
    return RemapPixel(p, resolution_, wrap) ? Get(p, channel) : 0;
}

void Image::Set(Point2i p, int channel, Float linear) {
    size_t i = Index(p, channel);
    switch (format_) {
        case PixelFormat::U8: u8_[i] = code_->Encode(linear); break;
        case PixelFormat::Half: {
            constexpr Float largest = 65504;
            half_[i] = imath_float_to_half(std::clamp(linear, -largest, largest));
            break;
        }
        case PixelFormat::Float: float_[i] = linear; break;
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

Image Image::Extract(const std::vector<std::string> &channels) const {
    std::vector<size_t> from;
    for (const std::string &name : channels) {
        int index = FindChannel(name);
        if (index < 0) throw UserError("The image has no channel \"{}\"; {}", name, ListChoices(name, channels_));
        from.push_back(index);
    }
    Image result(format_, resolution_, channels, encoding_);
    auto copy = [&](const auto &source, auto &target) {
        size_t pixels = source.size() / channels_.size(), out = 0;
        for (size_t i = 0; i < pixels; ++i)
            for (size_t c : from) target[out++] = source[i * channels_.size() + c];
    };
    copy(u8_, result.u8_);
    copy(half_, result.half_);
    copy(float_, result.float_);
    return result;
}

Image Image::Select(const std::vector<std::string> &channels) const {
    return Extract(channels).ConvertTo(PixelFormat::Float);
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
    size_t valueBytes = Bytes() / ValueCount(), rowBytes = result.Bytes() / bounds.Height();
    const std::byte *source = static_cast<const std::byte *>(Data());
    std::byte *target = static_cast<std::byte *>(result.Data());
    for (int y = bounds.low.y; y < bounds.high.y; ++y, target += rowBytes)
        std::memcpy(target, source + Index({bounds.low.x, y}, 0) * valueBytes, rowBytes);
    return result;
}

size_t Image::Bytes() const { return u8_.size() + half_.size() * sizeof(uint16_t) + float_.size() * sizeof(float); }

const void *Image::Data() const {
    switch (format_) {
        case PixelFormat::U8: return u8_.data();
        case PixelFormat::Half: return half_.data();
        case PixelFormat::Float: return float_.data();
    }
    return nullptr;
}

void *Image::Data() { return const_cast<void *>(static_cast<const Image &>(*this).Data()); }

}  // namespace pbrt
