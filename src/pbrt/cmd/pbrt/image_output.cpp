#include "pbrt/cmd/pbrt/image_output.h"

#include <filesystem>

#include "pbrt/core/error.h"

namespace pbrt {
namespace {

template <class T>
std::optional<T> Attribute(const ImageMetadata &m, const std::string &name) {
    auto it = m.attributes.find(name);
    if (it == m.attributes.end()) return {};
    const T *value = std::get_if<T>(&it->second);
    return value ? std::optional<T>(*value) : std::nullopt;
}

/// True if two images may show the same scene, so that their samples are comparable. Missing attributes count as equal.
bool MayShowTheSame(const ImageMetadata &a, const ImageMetadata &b) {
    for (const char *name : {"pbrt.scene", "pbrt.integrator"}) {
        const std::optional<std::string> one = Attribute<std::string>(a, name), other = Attribute<std::string>(b, name);
        if (one && other && *one != *other) return false;
    }
    return !a.fullResolution || !b.fullResolution || *a.fullResolution == *b.fullResolution;
}

}  // namespace

bool ImageOutput::KeepsOld(const ImageMetadata &metadata) {
    std::error_code none;
    if (isOurs_ || !std::filesystem::is_regular_file(filename_, none)) return false;
    if (!old_) try {
            old_ = ReadImage(filename_).metadata;
        } catch (const UserError &) {
            old_.emplace();  // its contents are unknown
        }
    if (!MayShowTheSame(*old_, metadata)) return false;
    const std::optional<int> had = Attribute<int>(*old_, "samplesPerPixel"),
                             has = Attribute<int>(metadata, "samplesPerPixel");
    return !had || !has || *had > *has;
}

void ImageOutput::WriteFinished(const Image &image, const ImageMetadata &metadata) {
    WriteImage(filename_, image, metadata);
    std::error_code ignored;
    if (wroteBeside_) std::filesystem::remove(BesideName(), ignored);
}

std::string ImageOutput::WriteUnfinished(const Image &image, const ImageMetadata &metadata) {
    if (KeepsOld(metadata)) {
        WriteImage(BesideName(), image, metadata);
        wroteBeside_ = true;
        return BesideName();
    }
    WriteImage(filename_, image, metadata);
    isOurs_ = true;
    std::error_code ignored;
    if (wroteBeside_) std::filesystem::remove(BesideName(), ignored);
    wroteBeside_ = false;
    return filename_;
}

}  // namespace pbrt
