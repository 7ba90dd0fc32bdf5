#include "ext/lab/reference.h"

#include <cstdlib>
#include <filesystem>

#include "ext/lab/sampler_run.h"
#include "ext/lab/text_output.h"
#include "ext/lab/tile_statistics.h"
#include "pbrt/core/error.h"
#include "pbrt/core/log.h"
#include "pbrt/core/version.h"
#include "pbrt/scenefile/content_hash.h"

namespace ext::lab {

namespace fs = std::filesystem;

namespace {

constexpr const char *kColors[3] = {"R", "G", "B"};

std::string PartChannel(size_t part, int color) { return fmt::format("part{}.{}", part + 1, kColors[color]); }

template <class T>
T Attribute(const ImageMetadata &m, const std::string &name, T otherwise) {
    auto it = m.attributes.find(name);
    if (it == m.attributes.end() || !std::holds_alternative<T>(it->second)) return otherwise;
    return std::get<T>(it->second);
}

std::optional<Reference> ReadCached(const std::string &path, Point2i resolution) {
    const ImageFile file = ReadImage(path);
    Reference reference;
    const int parts = Attribute(file.metadata, "lightlab.parts", 0);
    if (parts < 1 || file.image.Resolution() != resolution) return {};
    for (size_t part = 0; part < static_cast<size_t>(parts); ++part) {
        Image colors = file.image.Select({PartChannel(part, 0), PartChannel(part, 1), PartChannel(part, 2)});
        Image image(PixelFormat::Float, colors.Resolution(), {"R", "G", "B"});
        ForEachPixel(colors.Resolution(), [&](int x, int y) {
            for (int c = 0; c < 3; ++c) image.Set({x, y}, c, colors.Get({x, y}, c));
        });
        reference.parts.push_back(std::move(image));
    }
    AverageParts(&reference);
    if (!IsFinite(reference.image)) return {};
    reference.sampler = Attribute<std::string>(file.metadata, "lightlab.sampler", "");
    reference.samples = Attribute(file.metadata, "samplesPerPixel", 0);
    reference.seconds = double(Attribute(file.metadata, "renderTimeSeconds", 0.f));
    reference.source = path;
    return reference;
}

}  // namespace

ReferenceCache::ReferenceCache(const ExperimentSettings &settings, const LabScene &scene, const std::string &what)
    : resolution_(scene.Resolution()) {
    const Bounds2i &pixels = scene.Pixels();
    ContentHash hash;
    hash.Add(fmt::format("reference 1; scene {}; {}x{}, pixels {} {} {} {}; depth {}; batch {}; jitter {} {}; {}",
                         scene.hash, scene.FullResolution().x, scene.FullResolution().y, pixels.low.x, pixels.low.y,
                         pixels.high.x, pixels.high.y, scene.built.maxDepth, scene.Batch(),
                         scene.built.disablePixelJitter, scene.built.disableWavelengthJitter, what));
    if (settings.sampledLightOnly) hash.Add("sampled light");
    key_ = hash.Hex();
    const std::string name = fmt::format("{}.reference-{}.exr", fs::path(settings.scene).stem().string(), key_);
    if (!settings.cacheFolder.empty()) files_.push_back((fs::path(settings.cacheFolder) / name).string());
    files_.push_back((fs::path(settings.outFolder) / name).string());
}

std::optional<Reference> ReferenceCache::Find() const {
    for (const std::string &path : files_) {
        std::error_code ignored;
        if (!fs::exists(path, ignored)) continue;
        try {
            if (std::optional<Reference> found = ReadCached(path, resolution_)) return found;
            LogWarning(fmt::format("{}: is not the reference that belongs there; it is rendered again.", path));
        } catch (const UserError &e) {
            LogWarning(fmt::format("{} The reference is rendered again.", e.what()));
        }
    }
    return {};
}

void ReferenceCache::Store(const LabScene &scene, const std::string &about, Reference *reference) const {
    std::vector<std::string> channels = {"R", "G", "B"};
    for (size_t part = 0; part < reference->parts.size(); ++part)
        for (int c = 0; c < 3; ++c) channels.push_back(PartChannel(part, c));
    const Point2i resolution = reference->image.Resolution();
    Image all(PixelFormat::Float, resolution, channels);
    ForEachPixel(resolution, [&](int x, int y) {
        for (int c = 0; c < 3; ++c) {
            all.Set({x, y}, c, reference->image.Get({x, y}, c));
            for (size_t part = 0; part < reference->parts.size(); ++part)
                all.Set({x, y}, static_cast<int>(3 * (part + 1)) + c, reference->parts[part].Get({x, y}, c));
        }
    });
    ImageMetadata m = scene.built.film->Metadata();
    m.attributes["lightlab.sampler"] = reference->sampler;
    m.attributes["lightlab.parts"] = static_cast<int>(reference->parts.size());
    m.attributes["lightlab.reference"] = about;
    m.attributes["lightlab.sceneHash"] = scene.hash;
    m.attributes["lightlab.noiseRelL2"] = static_cast<float>(reference->noise.value_or(0));
    m.attributes["lightlab.date"] = DateText();
    m.attributes["samplesPerPixel"] = reference->samples;
    m.attributes["renderTimeSeconds"] = static_cast<float>(reference->seconds);
    m.attributes["pbrt.version"] = std::string(VersionText());
    m.attributes["pbrt.integrator"] = scene.built.integratorName;
    m.attributes["pbrt.maxDepth"] = scene.built.maxDepth;
    for (const std::string &path : files_) {
        const bool isLast = &path == &files_.back();
        try {
            std::error_code error;
            fs::create_directories(fs::path(path).parent_path(), error);
            WriteImage(path, all, m);
            reference->source = path;
            return;
        } catch (const std::exception &e) {
            if (isLast) throw;
            LogWarning(fmt::format(
                "{}: the reference cannot be kept there ({}); it is kept in the output folder. --cache DIR chooses "
                "another place.",
                path, e.what()));
        }
    }
}

std::string UserCacheFolder() {
    auto variable = [](const char *name) {
        const char *value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    // The XDG specification ignores relative paths.
    if (const fs::path cache = variable("XDG_CACHE_HOME"); cache.is_absolute()) return (cache / "pbrt_octree").string();
    if (const fs::path home = variable("HOME"); home.is_absolute()) return (home / ".cache" / "pbrt_octree").string();
    return {};
}

void AverageParts(Reference *reference) {
    std::vector<const Image *> images;
    for (const Image &part : reference->parts) images.push_back(&part);
    MeanImage mean = AverageImages(images);
    reference->image = std::move(mean.image);
    if (images.size() > 1) reference->noise = mean.noise;
}

Reference ReadReference(const std::string &path, const LabScene &scene) {
    const ImageFile file = ReadImage(path);
    const Bounds2i &wanted = scene.Pixels();
    const Bounds2i have = file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
    const Point2i full = file.metadata.fullResolution.value_or(file.image.Resolution());
    const bool covers = wanted.low.x >= have.low.x && wanted.low.y >= have.low.y && wanted.high.x <= have.high.x &&
                        wanted.high.y <= have.high.y;
    if (full != scene.FullResolution() || !covers)
        throw UserError(fmt::format(
            "{}: the reference is {} x {} pixels (x {}-{}, y {}-{} of them); the film is {} x {} "
            "and needs x {}-{}, y {}-{}. See --divisor.",
            path, full.x, full.y, have.low.x, have.high.x, have.low.y, have.high.y, scene.FullResolution().x,
            scene.FullResolution().y, wanted.low.x, wanted.high.x, wanted.low.y, wanted.high.y));
    const Bounds2i window{wanted.low - have.low, wanted.high - have.low};
    Reference reference;
    reference.image = file.image.Select({"R", "G", "B"}).Crop(window);
    if (!IsFinite(reference.image))
        throw UserError(fmt::format("{}: the reference has pixels that are not finite.", path));
    reference.sampler = Attribute<std::string>(file.metadata, "lightlab.sampler", "");
    reference.samples = Attribute(file.metadata, "samplesPerPixel", 0);
    reference.seconds = double(Attribute(file.metadata, "renderTimeSeconds", 0.f));
    reference.source = path;
    return reference;
}

}  // namespace ext::lab
