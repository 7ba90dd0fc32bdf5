#pragma once
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cmath>
#include <initializer_list>

#include "support/errors.h"
#include "support/folder_test.h"
#include "support/temporary_image.h"

namespace pbrt::test {

constexpr PixelFormat kFormats[] = {PixelFormat::U8, PixelFormat::Half, PixelFormat::Float};
inline const std::vector<std::string> kGrey = {"Y"}, kRgb = {"R", "G", "B"}, kRgba = {"R", "G", "B", "A"};

inline std::string Bytes(std::initializer_list<int> values) {
    std::string bytes;
    for (int v : values) bytes += char(v);
    return bytes;
}

/// Inverse of ColorEncoding::ToLinear.
inline Float Encoded(const ColorEncoding &encoding, Float linear) {
    using enum ColorEncoding::Kind;
    if (encoding.kind == Gamma) return std::pow(linear, 1 / encoding.gamma);
    if (encoding.kind == Linear) return linear;
    return linear <= .0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1 / 2.4f) - .055f;
}

inline std::string ReadError(const std::string &path) {
    return MessageOf([&] { ReadImage(path); });
}
/// What `act` writes to stderr.
template <class Act>
std::string StderrOf(const Act &act) {
    ::testing::internal::CaptureStderr();
    act();
    return ::testing::internal::GetCapturedStderr();
}

inline void WriteExr(const std::string &path, const Imf::Header &header,
                     const std::vector<std::pair<std::string, Imf::Slice>> &channels) {
    Imf::FrameBuffer buffer;
    for (const auto &[name, slice] : channels) buffer.insert(name, slice);
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(header.dataWindow().max.y + 1);
}

/// One row of grey pixels.
inline Image Row(std::initializer_list<Float> values) {
    Image image(PixelFormat::Float, {int(values.size()), 1}, kGrey);
    std::copy(values.begin(), values.end(), static_cast<float *>(image.Data()));
    return image;
}
inline void Fill(Image &image, int channel, Float value) {
    ForEachPixel(image, [&](Point2i p) { image.Set(p, channel, value); });
}

/// An image of pseudo-random values in [low, high], which all differ.
inline Image NoiseImage(PixelFormat format, Point2i resolution, std::vector<std::string> channels, Float low = 0,
                        Float high = 1, ColorEncoding encoding = {}) {
    Image image(format, resolution, std::move(channels), encoding);
    uint32_t state = 12345;
    ForEachValue(image, [&](Point2i p, int c) {
        state = state * 1664525u + 1013904223u;
        image.Set(p, c, low + (high - low) * Float(state >> 8) * 0x1p-24f);
    });
    return image;
}

inline void ExpectSamePixels(const Image &a, const Image &b, Float tolerance = 0) {
    ASSERT_EQ(a.Resolution(), b.Resolution());
    ASSERT_EQ(a.Channels(), b.Channels());
    ForEachValue(a, [&](Point2i p, int c) {
        ASSERT_NEAR(a.Get(p, c), b.Get(p, c), tolerance) << "x " << p.x << " y " << p.y << " channel " << c;
    });
}

}  // namespace pbrt::test
