#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "pbrt/core/error.h"
#include "pbrt/images/image.h"

namespace pbrt {

/// Writes the image of a render. The final image replaces any file. An unfinished one (interrupted, or after a wave) is
/// written beside an image of the same scene with more samples, or with an unknown number.
class ImageOutput {
  public:
    explicit ImageOutput(std::string filename) : filename_(std::move(filename)) {}

    const std::string &Filename() const { return filename_; }
    void WriteFinished(const Image &image, const ImageMetadata &metadata) {
        WriteImage(filename_, image, metadata);
        RemoveBeside();
    }
    /// Returns the name of the file written. `metadata` provides samples, scene and integrator.
    std::string WriteUnfinished(const Image &image, const ImageMetadata &metadata) {
        if (KeepsOld(metadata)) {
            WriteImage(beside_, image, metadata);
            wroteBeside_ = true;
            return beside_;
        }
        WriteImage(filename_, image, metadata);
        isOurs_ = true;
        RemoveBeside();
        return filename_;
    }

  private:
    /// True if two images may show the same scene: missing attributes count as equal.
    static bool MayShowTheSame(const ImageMetadata &a, const ImageMetadata &b) {
        for (const char *name : {"pbrt.scene", "pbrt.integrator"}) {
            const auto one = a.Attribute<std::string>(name), other = b.Attribute<std::string>(name);
            if (one && other && *one != *other) return false;
        }
        return !a.fullResolution || !b.fullResolution || *a.fullResolution == *b.fullResolution;
    }
    bool KeepsOld(const ImageMetadata &metadata) {
        std::error_code none;
        if (isOurs_ || !std::filesystem::is_regular_file(filename_, none)) return false;
        if (!old_) try {
                old_ = ReadImage(filename_).metadata;
            } catch (const UserError &) {
                old_.emplace();  // its contents are unknown
            }
        if (!MayShowTheSame(*old_, metadata)) return false;
        const auto had = old_->Attribute<int>("samplesPerPixel"), has = metadata.Attribute<int>("samplesPerPixel");
        return !had || !has || *had > *has;
    }
    void RemoveBeside() {
        std::error_code ignored;
        if (std::exchange(wroteBeside_, false)) std::filesystem::remove(beside_, ignored);
    }

    std::string filename_;
    std::string beside_ = WithSuffix(filename_, "-unfinished");  ///< "out-unfinished.exr" for "out.exr"
    bool isOurs_ = false, wroteBeside_ = false;
    /// Metadata of the file before this render, read on first use; without attributes if unreadable.
    std::optional<ImageMetadata> old_;
};

}  // namespace pbrt
