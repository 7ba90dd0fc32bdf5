#pragma once
#include <optional>
#include <string>

#include "pbrt/images/image.h"

namespace pbrt {

/// Writes the picture of a render. The finished picture replaces whatever the file held. An unfinished one
/// (interrupted, or after a wave) never replaces a better one: a picture of the same scene with more samples, or one
/// whose samples are unknown, stays, and the unfinished one is written beside it.
class ImageOutput {
  public:
    explicit ImageOutput(std::string filename) : filename_(std::move(filename)) {}

    const std::string &Filename() const { return filename_; }
    /// Returns "out-unfinished.exr" for "out.exr".
    std::string BesideName() const;
    void WriteFinished(const Image &image, const ImageMetadata &metadata);
    /// Returns the name of the file that was written. `metadata` names samples, scene and integrator.
    std::string WriteUnfinished(const Image &image, const ImageMetadata &metadata);

  private:
    bool KeepsOld(const ImageMetadata &metadata);
    std::string filename_;
    bool isOurs_ = false, wroteBeside_ = false;
    /// Metadata of the file as it was before this render wrote it, read when first needed; without attributes if the
    /// file cannot be read.
    std::optional<ImageMetadata> old_;
};

}  // namespace pbrt
