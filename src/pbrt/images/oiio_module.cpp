// All OpenImageIO calls, as a separate shared library; see image_library.h.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "pbrt/images/image_library.h"

namespace pbrt::oiio {
namespace {

OIIO::TypeDesc TypeOf(ValueType type) {
    using OIIO::TypeDesc;
    constexpr TypeDesc::BASETYPE kTypes[] = {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT};
    return kTypes[size_t(type)];
}

OIIO::ImageSpec SpecOf(const Pixels &p) { return {p.width, p.height, p.channels, TypeOf(p.type)}; }

void Check(bool done, const auto *source) {
    if (!done) throw std::runtime_error(source ? source->geterror() : OIIO::geterror());
}

// PNG channels kept by stock pbrt-v4: those in the file before transparency chunks, without the alpha of grey images.
// Byte 25 of the file is the colour type in IHDR.
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

/// Idle caches, reused after emptying and never destroyed. In OpenImageIO 2.4, a thread that used a destroyed cache
/// corrupts later ones: wrong texels or a failed assertion about tile memory (test
/// TileCache.ThreadsForgetTheCacheBefore).
struct IdleCaches {
    std::mutex mutex;
    std::vector<OIIO::ImageCache *> caches;

    OIIO::ImageCache *Take() {
        const std::scoped_lock lock(mutex);
        if (caches.empty()) return OIIO::ImageCache::create(false);
        OIIO::ImageCache *cache = caches.back();
        caches.pop_back();
        return cache;
    }
    void Return(OIIO::ImageCache *cache) {
        cache->invalidate_all(true);
        const std::scoped_lock lock(mutex);
        caches.push_back(cache);
    }
};
IdleCaches &Idle() {
    static IdleCaches &idle = *new IdleCaches;  // outlives all threads
    return idle;
}

class CachedTiles final : public TileStore {
  public:
    CachedTiles(int megabytes, int tileSize) : cache_(Idle().Take()), tileSize_(tileSize) {
        OIIO::attribute("tiff:half", 1);
        cache_->attribute("max_memory_MB", float(megabytes));
        cache_->attribute("max_open_files", 100);
        cache_->attribute("unassociatedalpha", 1);
    }
    ~CachedTiles() override { Idle().Return(cache_); }

    void *Add(const std::string &path, std::span<const Pixels> images) override {
        std::vector<OIIO::ImageSpec> specs;
        for (const Pixels &image : images) {
            OIIO::ImageSpec &spec = specs.emplace_back(SpecOf(image));
            spec.tile_width = spec.tile_height = tileSize_;
            spec.alpha_channel = -1;  // disables premultiplication
            spec["compression"] = "none";
        }
        std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
        Check(out != nullptr, out.get());
        Check(out->open(path, int(specs.size()), specs.data()), out.get());
        for (size_t i = 0; i < images.size(); ++i) {
            if (i > 0) Check(out->open(path, specs[i], OIIO::ImageOutput::AppendSubimage), out.get());
            Check(out->write_image(specs[i].format, images[i].data), out.get());
        }
        Check(out->close(), out.get());
        out.reset();
        // OpenImageIO does not report a full disk at the end of a file. The size of uncompressed tiles is known.
        uintmax_t expected = 0;
        for (const OIIO::ImageSpec &spec : specs) expected += spec.image_bytes();
        OIIO::ImageSpec last;
        std::error_code unknown;
        const uintmax_t written = std::filesystem::file_size(path, unknown);
        if (unknown || written < expected || !cache_->get_imagespec(OIIO::ustring(path), last, int(specs.size()) - 1))
            throw std::runtime_error("the tiles of a texture could not be written; is the disk full?");
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
        return size_t(bytes);
    }

  private:
    OIIO::ImageCache *cache_;
    int tileSize_;
};

class OpenInput final : public OpenFile {
  public:
    OpenInput(const std::string &path, std::unique_ptr<OIIO::ImageInput> input) : input_(std::move(input)) {
        const OIIO::ImageSpec &spec = input_->spec();
        if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
            throw std::runtime_error("not a plain two-dimensional image");
        width = spec.width;
        height = spec.height;
        format = input_->format_name();
        orientation = spec.get_int_attribute("Orientation", 1);
        const bool png = format == "png";
        channels = std::min(spec.nchannels, png ? PngChannels(path) : spec.nchannels >= 3 ? 3 : 1);
        // Everything except float and 16-bit PNG is read as 8 bit.
        type = spec.format.is_floating_point()     ? ValueType::Float
               : png && spec.format.basesize() > 1 ? ValueType::U16
                                                   : ValueType::U8;
    }
    void Read(void *pixels) override {
        Check(input_->read_image(0, 0, 0, channels, TypeOf(type), pixels), input_.get());
    }

  private:
    std::unique_ptr<OIIO::ImageInput> input_;
};

class OpenImageIO final : public ImageLibrary {
  public:
    std::unique_ptr<OpenFile> Open(const std::string &path) const override {
        OIIO::ImageSpec request;
        request["oiio:UnassociatedAlpha"] = 1;
        std::unique_ptr<OIIO::ImageInput> in;
        {
            // Up to OpenImageIO 2.4.7 reading two headers concurrently is a data race in the table of colour profile
            // tags: crashes, endless loops, or a crash at exit.
            static std::mutex opening;
            const std::lock_guard lock(opening);
            in = OIIO::ImageInput::open(path, &request);
        }
        const std::string reason = in ? "" : OIIO::geterror();
        // OpenImageIO's readers of further formats are not reliable: some crash.
        static constexpr std::string_view kFormats[] = {"png", "jpeg", "targa", "bmp", "gif",
                                                        "pnm", "psd",  "tiff",  "hdr"};
        if (in ? std::ranges::count(kFormats, std::string_view(in->format_name())) == 0
               : reason.find("could not find a format reader") != std::string::npos)
            throw std::runtime_error(
                "not an image of a known format; PNG, EXR, PFM, HDR, JPEG, TGA, BMP, GIF, PNM, "
                "PSD and TIFF files can be read");
        if (!in) throw std::runtime_error(reason);
        return std::make_unique<OpenInput>(path, std::move(in));
    }

    std::vector<unsigned char> Encode(const std::string &format, const Pixels &pixels) const override {
        OIIO::ImageSpec spec = SpecOf(pixels);
        spec["oiio:ColorSpace"] = "sRGB";
        spec["oiio:UnassociatedAlpha"] = 1;
        if (format == "jpeg") {
            spec["compression"] = "jpeg:95";
            spec["jpeg:subsampling"] = "4:4:4";
        }
        // In memory, because OpenImageIO does not report a full disk.
        std::vector<unsigned char> bytes;
        OIIO::Filesystem::IOVecOutput memory(bytes);
        std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(format);
        Check(out != nullptr, out.get());
        Check(out->set_ioproxy(&memory), out.get());
        // open() requires but ignores the name.
        Check(out->open("image." + format, spec) && out->write_image(spec.format, pixels.data) && out->close(),
              out.get());
        return bytes;
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
