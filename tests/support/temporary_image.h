#pragma once
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "pbrt/images/image.h"

namespace pbrt::test {

/// A temporary image file that is removed with the object.
class TemporaryImage {
  public:
    TemporaryImage(const std::string &name, const Image &image)
        : path_((std::filesystem::temp_directory_path() / (std::to_string(::getpid()) + name)).string()) {
        WriteImage(path_, image);
    }
    ~TemporaryImage() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    const std::string &Path() const { return path_; }

  private:
    std::string path_;
};

inline Image RgbImage(Point2i n, const std::function<Rgb(int, int)> &color) {
    Image image(PixelFormat::Float, n, {"R", "G", "B"});
    ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, color(p.x, p.y)[c]); });
    return image;
}

}  // namespace pbrt::test
