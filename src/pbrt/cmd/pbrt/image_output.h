#pragma once
#include <optional>
#include <string>

#include "pbrt/images/image.h"

namespace pbrt {

/// Where the picture of a render goes. The finished picture replaces whatever the file held, as asked. An unfinished
/// one (interrupted, or after a wave) never replaces a better one: a picture of the same scene with more samples, or
/// one whose samples are unknown, stays, and the unfinished one is written beside it.
class ImageOutput {
  public:
    explicit ImageOutput(std::string filename) : filename_(std::move(filename)) {}

    const std::string &Filename() const { return filename_; }
    /// "out-unfinished.exr" for "out.exr".
    std::string BesideName() const;
    void WriteFinished(const Image &image, const ImageMetadata &metadata);
    /// Returns the name of the file that was written. `metadata` says samples, scene and integrator.
    std::string WriteUnfinished(const Image &image, const ImageMetadata &metadata);

  private:
    bool KeepsOld(const ImageMetadata &metadata);
    std::string filename_;
    bool isOurs_ = false, wroteBeside_ = false;
    /// What the file held before this render wrote it, once asked; without attributes if it cannot be read.
    std::optional<ImageMetadata> old_;
};

}  // namespace pbrt
