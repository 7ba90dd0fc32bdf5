#pragma once
#include "support/temporary_image.h"
#include "unit/pbrt/cmd/pbrt/program.h"

namespace pbrt {

using test::ExpectWords, test::Has, test::Outcome, test::RgbImage;

inline const std::vector<std::string> kRgb = {"R", "G", "B"};

inline Image Constant(Point2i size, Float value) {
    Image image(PixelFormat::Float, size, kRgb);
    std::fill_n(static_cast<float *>(image.Data()), image.ValueCount(), value);
    return image;
}

inline Rgb RgbAt(const Image &image, Point2i p) { return {image.Get(p, 0), image.Get(p, 1), image.Get(p, 2)}; }

class Imgtool : public test::Program {
  protected:
    /// Runs the command, expects success, and reads the image that the last argument names.
    ImageFile Written(const std::string &arguments) const {
        RunWell(arguments);
        return ReadImage(Path(arguments.substr(arguments.rfind(' ') + 1)));
    }
    /// The cases are pairs of arguments and a part of the message.
    void ExpectErrors(const std::vector<std::pair<std::string, std::string>> &cases) const {
        std::vector<ErrorCase> all;
        for (const auto &[arguments, part] : cases) all.push_back({arguments, {part}});
        Program::ExpectErrors(all, "");
    }

    using Program::Write;
    /// Grey values side by side.
    void WriteRow(const std::string &name, const std::vector<Float> &values) const {
        Image image(PixelFormat::Float, {int(values.size()), 1}, {"Y"});
        std::copy(values.begin(), values.end(), static_cast<float *>(image.Data()));
        WriteImage(Path(name), image);
    }
    /// Values 0.1, 0.2, ... in every channel.
    Image Write(const std::string &name, int width, int height, const std::vector<std::string> &channels,
                Float offset = 0) const {
        Image image(PixelFormat::Float, {width, height}, channels);
        Float value = offset;
        ForEachValue(image, [&](Point2i p, int c) { image.Set(p, c, value += 0.1f); });
        WriteImage(Path(name), image);
        return image;
    }
};

}  // namespace pbrt
