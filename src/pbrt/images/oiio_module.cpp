// The one file that calls OpenImageIO; a shared library of its own, see image_library.h.
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>

#include "pbrt/images/image_library.h"

namespace pbrt::oiio {

namespace {

OIIO::TypeDesc TypeOf(ValueType type) {
    switch (type) {
    case ValueType::U8: return OIIO::TypeDesc::UINT8;
    case ValueType::U16: return OIIO::TypeDesc::UINT16;
    case ValueType::Half: return OIIO::TypeDesc::HALF;
    case ValueType::Float: break;
    }
    return OIIO::TypeDesc::FLOAT;
}

OIIO::ImageSpec SpecOf(const Pixels &p) { return {p.width, p.height, p.channels, TypeOf(p.type)}; }

template <class Source>
void Check(bool done, const Source *source) {
    if (!done) throw std::runtime_error(source ? source->geterror() : OIIO::geterror());
}

// Channels stock pbrt-v4 keeps of a PNG: what the file says before transparency chunks are applied, without the
// alpha of grey images. 25 bytes into the file is IHDR's colour type.
int PngChannels(const std::string &path) {
    std::array<char, 26> head{};
    std::ifstream(path, std::ios::binary).read(head.data(), head.size());
    switch (head[25]) {
    case 0:
    case 4: return 1;
    case 6: return 4;
    default: return 3;
    }
}

class CachedTiles final : public TileStore {
  public:
    CachedTiles(int megabytes, int tileSize) : cache_(OIIO::ImageCache::create(false)), tileSize_(tileSize) {
        OIIO::attribute("tiff:half", 1);
        cache_->attribute("max_memory_MB", static_cast<float>(megabytes));
        cache_->attribute("max_open_files", 100);
        cache_->attribute("unassociatedalpha", 1);
    }
    ~CachedTiles() override { OIIO::ImageCache::destroy(cache_); }

    void *Add(const std::string &path, std::span<const Pixels> images) override {
        std::vector<OIIO::ImageSpec> specs;
        for (const Pixels &image : images) {
            OIIO::ImageSpec &spec = specs.emplace_back(SpecOf(image));
            spec.tile_width = spec.tile_height = tileSize_;
            spec.alpha_channel = -1;  // values are to come back as they are
            spec["compression"] = "none";
        }
        std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
        Check(out != nullptr, out.get());
        Check(out->open(path, static_cast<int>(specs.size()), specs.data()), out.get());
        for (size_t i = 0; i < images.size(); ++i) {
            if (i > 0) Check(out->open(path, specs[i], OIIO::ImageOutput::AppendSubimage), out.get());
            Check(out->write_image(specs[i].format, images[i].data), out.get());
        }
        Check(out->close(), out.get());
        void *file = cache_->get_image_handle(OIIO::ustring(path));
        Check(file != nullptr, cache_);
        return file;
    }

    void *GetTile(void *file, int image, int x, int y) override {
        return cache_->get_tile(static_cast<OIIO::ImageCache::ImageHandle *>(file), nullptr, image, 0, x, y, 0);
    }
    const void *PixelsOf(void *tile) override {
        OIIO::TypeDesc format;
        return cache_->tile_pixels(static_cast<OIIO::ImageCache::Tile *>(tile), format);
    }
    void Release(void *tile) override { cache_->release_tile(static_cast<OIIO::ImageCache::Tile *>(tile)); }
    std::string Error() override { return cache_->geterror(); }
    size_t Bytes() override {
        long long bytes = 0;
        cache_->getattribute("stat:cache_memory_used", OIIO::TypeDesc::INT64, &bytes);
        return static_cast<size_t>(bytes);
    }

  private:
    OIIO::ImageCache *cache_;
    int tileSize_;
};

class OpenImageIO final : public ImageLibrary {
  public:
    File Read(const std::string &path) const override {
        OIIO::ImageSpec request;
        request["oiio:UnassociatedAlpha"] = 1;
        std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &request);
        if (!in) {
            const std::string reason = OIIO::geterror();
            if (reason.find("could not find a format reader") == std::string::npos) throw std::runtime_error(reason);
            throw std::runtime_error("not an image of a known format; PNG, EXR, PFM, HDR, JPEG, TGA, BMP, GIF, PNM, "
                                     "PSD and TIFF files can be read");
        }
        const OIIO::ImageSpec &spec = in->spec();
        if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
            throw std::runtime_error("not a plain two-dimensional image");
        File file;
        file.format = in->format_name();
        file.orientation = spec.get_int_attribute("Orientation", 1);
        const bool png = file.format == "png";
        const int kept = std::min(spec.nchannels, png ? PngChannels(path) : spec.nchannels >= 3 ? 3 : 1);
        // What is neither float nor a deep PNG counts as 8 bit.
        const ValueType type = spec.format.is_floating_point()         ? ValueType::Float
                               : png && spec.format.basesize() > 1 ? ValueType::U16
                                                                       : ValueType::U8;
        file.values.resize(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height) *
                           static_cast<size_t>(kept) * TypeOf(type).size());
        Check(in->read_image(0, 0, 0, kept, TypeOf(type), file.values.data()), in.get());
        file.pixels = {spec.width, spec.height, kept, type, file.values.data()};
        return file;
    }

    void WritePng(const std::string &path, const Pixels &pixels) const override {
        OIIO::ImageSpec spec = SpecOf(pixels);
        spec["oiio:ColorSpace"] = "sRGB";
        spec["oiio:UnassociatedAlpha"] = 1;
        std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create("png");
        Check(out != nullptr, out.get());
        Check(out->open(path, spec) && out->write_image(spec.format, pixels.data) && out->close(), out.get());
    }

    std::unique_ptr<TileStore> MakeTileStore(int megabytes, int tileSize) const override {
        return std::make_unique<CachedTiles>(megabytes, tileSize);
    }
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const ImageLibrary *PbrtImageLibrary() {
    static const OpenImageIO library;
    return &library;
}

}  // namespace pbrt::oiio
