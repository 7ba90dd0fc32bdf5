#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <mutex>
#include <set>

#include "pbrt/core/error.h"
#include "pbrt/core/log.h"
#include "pbrt/images/image_formats.h"

namespace pbrt::formats {
namespace {

// Attributes that are mandatory, or represented by the pixels or other fields of ImageMetadata.
const std::set<std::string> StructuralAttributes = {
    "channels",          "chromaticities", "chunkCount", "compression",      "dataWindow", "displayWindow",
    "lineOrder",         "multiView",      "name",       "pixelAspectRatio", "preview",    "screenWindowCenter",
    "screenWindowWidth", "tiles",          "type",       "version",          "view",       "whiteLuminance"};

// Channels in Image order: the unnamed layer first; within a layer R, G, B, A, then the rest by name.
std::vector<std::string> OrderedNames(const Imf::ChannelList &channels) {
    auto key = [](const std::string &name) {
        size_t dot = name.rfind('.');
        std::string layer = dot == std::string::npos ? "" : name.substr(0, dot);
        std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
        size_t rank = last.size() == 1 ? std::string("RGBA").find(last) : std::string::npos;
        return std::tuple(layer, rank, last);
    };
    std::vector<std::string> names;
    for (auto it = channels.begin(); it != channels.end(); ++it) names.emplace_back(it.name());
    std::sort(names.begin(), names.end(), [&](const auto &a, const auto &b) { return key(a) < key(b); });
    return names;
}

Point2 ToPoint(const Imath::V2f &v) { return {v.x, v.y}; }
Imath::V2f ToImath(const Point2 &p) { return {p.x, p.y}; }

const ColorSpace *FindSpace(const Imf::Header &header, const std::string &path) {
    if (!Imf::hasChromaticities(header)) return nullptr;
    const Imf::Chromaticities &c = Imf::chromaticities(header);
    const ColorSpace *space =
        ColorSpace::FromChromaticities(ToPoint(c.red), ToPoint(c.green), ToPoint(c.blue), ToPoint(c.white));
    if (!space)
        LogWarning(
            "{}: the chromaticities r ({}, {}) g ({}, {}) b ({}, {}) white ({}, {}) are those of no "
            "known colour space; sRGB is assumed.",
            path, c.red.x, c.red.y, c.green.x, c.green.y, c.blue.x, c.blue.y, c.white.x, c.white.y);
    return space;
}

void ReadAttributes(const Imf::Header &header, ImageMetadata &metadata) {
    for (auto it = header.begin(); it != header.end(); ++it) {
        if (StructuralAttributes.contains(it.name())) continue;
        const Imf::Attribute &a = it.attribute();
        auto take = [&](const auto *typed) {
            if (typed) metadata.attributes[it.name()] = typed->value();
        };
        take(dynamic_cast<const Imf::IntAttribute *>(&a));
        take(dynamic_cast<const Imf::FloatAttribute *>(&a));
        take(dynamic_cast<const Imf::StringAttribute *>(&a));
        if (auto *m = dynamic_cast<const Imf::M44fAttribute *>(&a)) {
            glm::mat4 matrix;
            for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m->value()[i % 4][i / 4];
            metadata.attributes[it.name()] = matrix;
        }
    }
}

template <class T>
const T &ToImath(const T &value) {
    return value;
}
Imath::M44f ToImath(const glm::mat4 &v) {
    Imath::M44f m;
    for (int i = 0; i < 16; ++i) m[i % 4][i / 4] = v[i / 4][i % 4];
    return m;
}

Imf::FrameBuffer Bind(const std::vector<std::string> &names, Imf::PixelType type, char *pixels,
                      const Imath::Box2i &window) {
    size_t valueBytes = type == Imf::HALF ? 2 : 4;
    size_t xStride = names.size() * valueBytes;
    size_t yStride = xStride * (window.max.x - window.min.x + 1);
    Imf::FrameBuffer buffer;
    for (size_t c = 0; c < names.size(); ++c)
        buffer.insert(names[c], Imf::Slice::Make(type, pixels + c * valueBytes, window, xStride, yStride));
    return buffer;
}

constexpr int64_t kMaxOffset = 1 << 28;  // largest offset of a window from the origin, in pixels

int64_t Extent(int low, int high) { return int64_t(high) - low + 1; }

/// Upper bound on pixel bytes per file byte.
double MaxExpansion(Imf::Compression compression) {
    switch (compression) {
        case Imf::NO_COMPRESSION:
            return 2;  // files that mix half and float become float
        // Bound for run lengths, or deflate of constant data.
        case Imf::RLE_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION: return 4000;
        default: return Infinity;
    }
}

void WarnOfParts(const std::string &path) {
    constexpr int kMaxNames = 8;
    const Imf::MultiPartInputFile file(path.c_str());
    const int count = file.parts();
    if (count < 2) return;
    std::string names;
    for (int i = 0; i < std::min(count, kMaxNames); ++i) {
        const Imf::Header &header = file.header(i);
        names += fmt::format("{}\"{}\"", i ? ", " : "", header.hasName() ? Abbreviate(header.name()) : "");
    }
    LogWarning("{}: the image has {} parts ({}{}); only the first is read.", path, count, names,
               count > kMaxNames ? ", ..." : "");
}

}  // namespace

ImageFile ReadExr(const std::string &path) {
    // Must be set before OpenEXR reads a header, because it allocates the header's sizes.
    static std::once_flag limited;
    std::call_once(limited, Imf::Header::setMaxImageSize, kMaxImageSide, kMaxImageSide);
    Imf::InputFile file(path.c_str());
    if (Imf::isMultiPart(file.version())) WarnOfParts(path);
    const Imf::Header &header = file.header();
    const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
    bool allHalf = true;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
        const Imf::Channel &channel = it.channel();
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw UserError("{}: channel \"{}\" is subsampled, which is not supported.", path, it.name());
        if (channel.type == Imf::UINT)
            throw UserError("{}: channel \"{}\" holds integers; only half and float are supported.", path, it.name());
        allHalf = allHalf && channel.type == Imf::HALF;
    }
    std::vector<std::string> names = OrderedNames(header.channels());
    if (names.empty()) throw UserError("{}: the image has no channels.", path);
    CheckSize(path, Extent(data.min.x, data.max.x), Extent(data.min.y, data.max.y), names.size(), allHalf ? 2 : 4,
              MaxExpansion(header.compression()));
    if (Extent(display.min.x, display.max.x) > INT_MAX || Extent(display.min.y, display.max.y) > INT_MAX)
        throw UserError("{}: the display window is impossibly large.", path);
    for (int corner : {data.min.x, data.min.y, display.min.x, display.min.y})
        if (std::abs(int64_t(corner)) > kMaxOffset)
            throw UserError("{}: a window begins at {}; at most {} from the origin are supported.", path, corner,
                            kMaxOffset);
    ImageFile result;
    ImageMetadata &metadata = result.metadata;
    metadata.pixelBounds = Bounds2i{{data.min.x - display.min.x, data.min.y - display.min.y},
                                    {data.max.x - display.min.x + 1, data.max.y - display.min.y + 1}};
    metadata.fullResolution = Point2i(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
    metadata.colorSpace = FindSpace(header, path);
    ReadAttributes(header, metadata);

    result.image = Image(allHalf ? PixelFormat::Half : PixelFormat::Float,
                         {metadata.pixelBounds->Width(), metadata.pixelBounds->Height()}, names);
    file.setFrameBuffer(Bind(names, allHalf ? Imf::HALF : Imf::FLOAT, static_cast<char *>(result.image.Data()), data));
    file.readPixels(data.min.y, data.max.y);
    return result;
}

std::string EncodeExr(const std::string &path, const Image &image, const ImageMetadata &metadata) {
    Bounds2i bounds = metadata.pixelBounds.value_or(Bounds2i{{0, 0}, image.Resolution()});
    PBRT_CHECK_MSG(bounds.Width() == image.Resolution().x && bounds.Height() == image.Resolution().y,
                   "data window {} x {}, image {} x {}", bounds.Width(), bounds.Height(), image.Resolution().x,
                   image.Resolution().y);
    Point2i full = metadata.fullResolution.value_or(bounds.high);
    Imath::Box2i display({0, 0}, {full.x - 1, full.y - 1});
    Imath::Box2i data({bounds.low.x, bounds.low.y}, {bounds.high.x - 1, bounds.high.y - 1});
    Imf::Header header(display, data);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (metadata.colorSpace && metadata.colorSpace != &ColorSpace::SRGB()) {
        const ColorSpace &s = *metadata.colorSpace;
        Imf::addChromaticities(header, {ToImath(s.R()), ToImath(s.G()), ToImath(s.B()), ToImath(s.White())});
    }
    for (const auto &[name, value] : metadata.attributes) {
        PBRT_CHECK_MSG(!StructuralAttributes.contains(name), "attribute {}", name);
        const auto write = [&, &name = name](const auto &v) { header.insert(name, Imf::TypedAttribute(ToImath(v))); };
        std::visit(write, value);
    }

    const bool asFloat = image.Format() == PixelFormat::Float;
    const Image pixels = asFloat ? image : image.ConvertTo(PixelFormat::Half);
    size_t clamped = 0;
    if (!asFloat) ForEachValue(pixels, [&](Point2i p, int c) { clamped += std::abs(pixels.Get(p, c)) >= kMaxHalf; });
    if (clamped > 0)
        LogWarning("{}: {} values are at or beyond {}, the largest in half precision.", path, clamped, kMaxHalf);
    Imf::PixelType type = asFloat ? Imf::FLOAT : Imf::HALF;
    for (const std::string &name : image.Channels()) {
        if (header.channels().findChannel(name)) throw UserError("{}: channel \"{}\" is given twice.", path, name);
        header.channels().insert(name, Imf::Channel(type));
    }
    // In memory, because OpenEXR does not report errors on closing a file.
    Imf::StdOSStream stream;
    {
        // The destructor writes the remaining content.
        Imf::OutputFile file(stream, header);
        // OpenEXR only reads through the frame buffer of an output file.
        file.setFrameBuffer(Bind(image.Channels(), type, static_cast<char *>(const_cast<void *>(pixels.Data())), data));
        file.writePixels(data.max.y - data.min.y + 1);
    }
    return stream.str();
}

}  // namespace pbrt::formats
