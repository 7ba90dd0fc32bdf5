#include "pbrt/cmd/imgtool/commands.h"

#include "pbrt/core/error.h"

namespace pbrt::imgtool {

std::vector<std::string> SplitChannels(const std::string &list) {
    std::vector<std::string> names = CLI::detail::split(list, ',');
    for (const std::string &name : names)
        if (name.empty()) throw UserError(fmt::format("--channels {}: a channel name is empty.", list));
    return names;
}

Bounds2i CropBounds(const std::vector<int> &n, Point2i resolution, const std::string &path) {
    PBRT_CHECK(n.size() == 4);
    Bounds2i bounds{{n[0], n[2]}, {n[1], n[3]}};
    if (bounds.IsEmpty())
        throw UserError(
            fmt::format("--crop {},{},{},{}: nothing is left; the order is x0,x1,y0,y1.", n[0], n[1], n[2], n[3]));
    if (bounds.low.x < 0 || bounds.low.y < 0 || bounds.high.x > resolution.x || bounds.high.y > resolution.y)
        throw UserError(fmt::format("--crop {},{},{},{}: {} has only {} x {} pixels.", n[0], n[1], n[2], n[3], path,
                                    resolution.x, resolution.y));
    return bounds;
}

void ApplyCrop(ImageFile &file, const std::vector<int> &numbers, const std::string &path) {
    if (numbers.empty()) return;
    Bounds2i bounds = CropBounds(numbers, file.image.Resolution(), path);
    file.image = file.image.Crop(bounds);
    Bounds2i &window = file.metadata.pixelBounds ? *file.metadata.pixelBounds : file.metadata.pixelBounds.emplace();
    window = {window.low + bounds.low, window.low + bounds.high};
}

CLI::Option *AddCropOption(CLI::App &command, std::vector<int> &numbers) {
    return command
        .add_option("--crop", numbers, "Only these pixels: columns x0 up to x1, rows y0 up to y1 (ends excluded)")
        ->delimiter(',')
        ->expected(4)
        ->type_name("x0,x1,y0,y1");
}

ImageFile ReadAsFloat(const std::string &path) {
    ImageFile file = ReadImage(path);
    file.image = file.image.ConvertTo(PixelFormat::Float);
    return file;
}

}  // namespace pbrt::imgtool
