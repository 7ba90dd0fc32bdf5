#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {
namespace {

struct SplitnOptions {
    std::vector<std::string> paths, crops;
    std::string outfile;
    int cropSize = 96;
};

constexpr int kGap = 4;  // pixels between parts

Point2i ParseCorner(const std::string &text) {
    std::vector<std::string> xy = CLI::detail::split(text, ',');
    Point2i p(0);
    if (text.ends_with(',') || xy.size() != 2 || !ReadNumber(xy[0], p.x) || !ReadNumber(xy[1], p.y))
        throw UserError("--crop {}: two whole numbers x,y were expected.", text);
    return p;
}

/// Layout: vertical strips of the images side by side, together as large as one image. Below, one row per crop with the
/// same square of each image, at an integer magnification.
struct Layout {
    Point2i picture;
    int images, cropSize, zoom, step;

    Layout(Point2i resolution, int imageCount, int size) : picture(resolution), images(imageCount), cropSize(size) {
        zoom = std::max(1, (picture.x - kGap * (images - 1)) / (images * cropSize));
        step = cropSize * zoom + kGap;
    }
    Point2i Size(int rows) const { return {std::max(picture.x, images * step - kGap), picture.y + rows * step}; }
    int StripOf(int x) const { return int(int64_t(x) * images / picture.x); }
    Point2i CropAt(int image, int row) const { return {image * step, picture.y + kGap + row * step}; }
};

int Splitn(const SplitnOptions &o) {
    if (o.paths.size() < 2) throw UserError("splitn needs at least two images.");
    std::vector<Point2i> corners;
    for (const std::string &text : o.crops) corners.push_back(ParseCorner(text));
    std::vector<ImageFile> files;
    for (const std::string &path : o.paths) {
        files.push_back(ReadAsFloat(path));
        CheckComparable(files[0], o.paths[0], files.back(), path);
    }
    const Point2i resolution = files[0].image.Resolution();
    const Bounds2i window = WindowOf(files[0]);
    for (size_t i = 0; i < corners.size(); ++i)
        if (corners[i].x < window.low.x || corners[i].y < window.low.y || corners[i].x > window.high.x - o.cropSize ||
            corners[i].y > window.high.y - o.cropSize)
            throw UserError("--crop {}: a square of {} pixels there reaches beyond the {} of the images.", o.crops[i],
                            o.cropSize, SizeText(files[0].image));

    const Layout layout(resolution, int(files.size()), o.cropSize);
    Image result(PixelFormat::Float, layout.Size(int(corners.size())), files[0].image.Channels());
    auto copy = [&](Point2i to, const Image &image, Point2i from) {
        for (int c = 0; c < image.ChannelCount(); ++c) result.Set(to, c, image.Get(from, c));
    };
    std::fill_n(static_cast<float *>(result.Data()), result.ValueCount(), 1.f);
    ForEachPixel(files[0].image, [&](Point2i p) {
        const int strip = layout.StripOf(p.x);
        const bool border = p.x + 1 < resolution.x && layout.StripOf(p.x + 1) != strip;
        if (!border) copy(p, files[strip].image, p);
    });
    for (size_t row = 0; row < corners.size(); ++row)
        for (int i = 0; i < layout.images; ++i) {
            const Point2i at = layout.CropAt(i, int(row));
            for (int y = 0; y < layout.step - kGap; ++y)
                for (int x = 0; x < layout.step - kGap; ++x)
                    copy(at + Point2i(x, y), files[i].image, corners[row] - window.low + Point2i(x, y) / layout.zoom);
        }
    ImageMetadata metadata;
    metadata.colorSpace = files[0].metadata.colorSpace;
    WriteImage(o.outfile, result, metadata);
    return 0;
}

}  // namespace

void AddSplitn(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Splitn, "splitn", "One image in strips of several images, with crops of each below",
                   "Example: imgtool splitn bvh.exr power.exr --crop 120,40 --cropsize 64 --outfile compare.png");
    AddFlags(command, {Flag("files", o.paths, "Images of one size; the first gives the leftmost strip").Required(),
                       OutfileFlag(o.outfile)});
    command
        .add_option("--crop", o.crops,
                    "Upper left corner of a square; a row below the strips shows this square of every image, enlarged "
                    "if there is room; may be given several times")
        ->allow_extra_args(false)
        ->type_name("x,y");
    AddFlags(command,
             {Flag("--cropsize", o.cropSize, "Side of the squares in pixels", ValidRange{1, 1 << 16}).ShowDefault()});
    command.get_option("--cropsize")->needs(command.get_option("--crop"));
}

}  // namespace pbrt::imgtool
