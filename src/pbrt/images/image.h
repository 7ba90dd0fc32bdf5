#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/math/bounds.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

enum class PixelFormat { U8, Half, Float };
inline constexpr Float kMaxHalf = 65504;       ///< largest finite half
inline constexpr int kMaxImageSide = 1 << 20;  ///< largest width and height of a film or an image file, in pixels

/// Encoding of stored 8/16-bit values (pbrt-v4-format §8, §14).
struct ColorEncoding {
    enum class Kind { Linear, SRGB, Gamma } kind = Kind::SRGB;
    Float gamma = 1;
    /// "linear", "sRGB", "gamma X"; nullopt if none of these.
    static std::optional<ColorEncoding> Parse(const std::string &name);
    Float ToLinear(Float encoded) const;
    auto operator<=>(const ColorEncoding &) const = default;
};

class ByteCode {
  public:
    /// Shared tables of an encoding, never freed. Takes a lock, so call it once per image.
    static const ByteCode &Of(const ColorEncoding &encoding);
    explicit ByteCode(const ColorEncoding &encoding);

    const float *DecodeTable() const { return decode_.data(); }
    Float Decode(uint8_t byte) const { return decode_[byte]; }
    /// Byte of the nearest encoded value; clamps to [0, 1], NaN gives 0.
    uint8_t Encode(Float linear) const;

  private:
    static constexpr size_t Cells = 4096;
    std::array<float, 256> decode_;
    std::array<float, 257> limits_;     ///< byte b encodes the values in [limits_[b], limits_[b + 1])
    std::array<uint8_t, Cells> guess_;  ///< per equal cell of [0, 1): byte of its smallest value
};

enum class WrapMode { Repeat, Black, Clamp, OctahedralSphere };
/// Wraps pixel coordinates into the image; false: outside and black. OctahedralSphere folds across the edges of the
/// equal-area octahedral square; -x maps to x there, as in stock pbrt-v4.
bool RemapPixel(Point2i &p, Point2i resolution, WrapMode wrap);

/// Interleaved pixels, row 0 at the top, decoded to linear values on access. 8-bit data keep their encoding and are
/// decoded through a table.
class Image {
  public:
    Image() = default;
    /// Black. Throws UserError if it needs more than UsableMemory().
    Image(PixelFormat format, Point2i resolution, std::vector<std::string> channels, ColorEncoding encoding = {});

    explicit operator bool() const { return resolution_.x > 0; }
    PixelFormat Format() const { return format_; }
    Point2i Resolution() const { return resolution_; }
    int ChannelCount() const { return int(channels_.size()); }
    const std::vector<std::string> &Channels() const { return channels_; }
    const ColorEncoding &Encoding() const { return encoding_; }
    size_t ValueCount() const { return Index({0, resolution_.y}, 0); }
    int FindChannel(const std::string &name) const {
        const auto found = std::ranges::find(channels_, name);
        return found == channels_.end() ? -1 : int(found - channels_.begin());
    }
    bool HasRgb() const { return FindChannel("R") >= 0 && FindChannel("G") >= 0 && FindChannel("B") >= 0; }

    Float Get(Point2i p, int channel) const;  ///< p inside the image
    Float Get(Point2i p, int channel, WrapMode wrap) const {
        return RemapPixel(p, resolution_, wrap) ? Get(p, channel) : 0;
    }
    /// Clamps bytes to [0, 1], halves to the largest finite half (WriteImage reports those).
    void Set(Point2i p, int channel, Float linear);
    /// Bilinear at st in [0,1]^2, pixel centres at half-integers.
    Float Bilinear(Point2 st, int channel, WrapMode wrap) const;
    /// Returns the named channels as float. Throws UserError if one is missing; `name`: subject of its message.
    Image Select(const std::vector<std::string> &channels, const std::string &name = "The image") const {
        return Extract(channels, name).ConvertTo(PixelFormat::Float);
    }
    /// As many names as there are channels.
    void RenameChannels(std::vector<std::string> names) { channels_ = std::move(names); }
    /// As Select, but keeps format and encoding.
    Image Extract(const std::vector<std::string> &channels, const std::string &name = "The image") const;
    Image ConvertTo(PixelFormat format) const;
    /// `bounds` must lie inside the image.
    Image Crop(const Bounds2i &bounds) const;
    size_t Bytes() const { return data_.size(); }
    const void *Data() const { return data_.data(); }
    void *Data() { return data_.data(); }

  private:
    size_t Index(Point2i p, int channel) const {
        return (size_t(p.y) * resolution_.x + p.x) * channels_.size() + channel;
    }
    template <class T>
    const T *As() const {
        return static_cast<const T *>(Data());
    }
    PixelFormat format_ = PixelFormat::Float;
    Point2i resolution_{0, 0};
    std::vector<std::string> channels_;
    ColorEncoding encoding_;
    const ByteCode *code_ = nullptr;  ///< null unless the format is U8
    std::vector<std::byte> data_;     ///< values: bytes, bits of halves, or floats
};

/// Calls f(p) for the pixels row by row, or f(p, channel) for their values.
void ForEachPixel(const Image &image, auto &&f) {
    for (int y = 0; y < image.Resolution().y; ++y)
        for (int x = 0; x < image.Resolution().x; ++x) f(Point2i(x, y));
}
void ForEachValue(const Image &image, auto &&f) {
    ForEachPixel(image, [&](Point2i p) {
        for (int c = 0; c < image.ChannelCount(); ++c) f(p, c);
    });
}

struct ImageMetadata {
    std::optional<Bounds2i> pixelBounds;     ///< data window within fullResolution
    std::optional<Point2i> fullResolution;   ///< display window
    const ColorSpace *colorSpace = nullptr;  ///< from chromaticities; null: unspecified (sRGB)
    using Value = std::variant<int, float, std::string, glm::mat4>;
    /// EXR header attributes by name. Matrices use column vectors; files get the layout of format §14.
    std::map<std::string, Value> attributes;
    /// Empty if there is no attribute of this name and type.
    template <class T>
    std::optional<T> Attribute(const std::string &name) const {
        const auto it = attributes.find(name);
        const T *value = it == attributes.end() ? nullptr : std::get_if<T>(&it->second);
        return value ? std::optional<T>(*value) : std::nullopt;
    }
};

struct ImageFile {
    Image image;
    ImageMetadata metadata;
};

/// Reads EXR, PNG, PFM, HDR, TGA, JPG, ... (not QOI), see format §14. `encoding` is for 8/16-bit PNG; nullopt: the
/// format's default (sRGB for png; other 8-bit formats are always sRGB). EXR channels keep their names, others are R,
/// G, B (and A) or Y. Throws UserError (no location) if missing or unreadable.
ImageFile ReadImage(const std::string &path, std::optional<ColorEncoding> encoding = {});

/// Writes by WriteFile in the format of the case-insensitive extension: .exr (half unless the image is float), .png and
/// .jpg (8 bit, sRGB, clamped), .pfm. Outside EXR, images of more than 4 channels keep only R, G, B, with a warning,
/// and other colour spaces are converted to sRGB. Throws UserError.
void WriteImage(const std::string &path, const Image &image, const ImageMetadata &metadata = {});

/// Throws UserError unless the name of a rendered image ends in .exr, .png or .pfm (case-insensitive). CheckWritable
/// (core/files.h) tests whether the file can be written.
void CheckImageName(const std::string &path, const FileLoc &loc);

/// Inserts a suffix before the extension: "out-more.exr" for "out.exr" and "-more".
std::string WithSuffix(const std::string &path, const std::string &suffix);

}  // namespace pbrt
