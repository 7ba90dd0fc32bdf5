#pragma once
#include <optional>
#include <string>

#include "pbrt/images/image.h"

namespace pbrt {

/// Writes the image of a render. The final image replaces any file. An unfinished one (interrupted, or after a wave) is
/// written beside an image of the same scene with more samples, or with an unknown number.
class ImageOutput {
  public:
    explicit ImageOutput(std::string filename) : filename_(std::move(filename)) {}

    const std::string &Filename() const { return filename_; }
    /// "out-unfinished.exr" for "out.exr".
    std::string BesideName() const { return WithSuffix(filename_, "-unfinished"); }
    void WriteFinished(const Image &image, const ImageMetadata &metadata);
    /// Returns the name of the file written. `metadata` provides samples, scene and integrator.
    std::string WriteUnfinished(const Image &image, const ImageMetadata &metadata);

  private:
    bool KeepsOld(const ImageMetadata &metadata);
    std::string filename_;
    bool isOurs_ = false, wroteBeside_ = false;
    /// Metadata of the file before this render, read on first use; without attributes if unreadable.
    std::optional<ImageMetadata> old_;
};

}  // namespace pbrt
