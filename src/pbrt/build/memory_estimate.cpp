#include "pbrt/build/built_scene.h"

#include <zlib.h>

#include <set>
#include <sstream>

namespace pbrt {
namespace {

/// Lower bound of Embree's bytes per triangle, validated by a test. A patch counts as two triangles.
constexpr double kAccelerationPerTriangle = 50;

struct MeshCounts {
    double vertices = 0, triangles = 0, bytesPerVertex = sizeof(Point3);
    double Bytes() const {
        return vertices * bytesPerVertex + triangles * (3 * sizeof(int) + kAccelerationPerTriangle);
    }
};

/// First bytes of a file, decompressed; empty if unreadable, which building reports.
std::string HeadOf(const std::string &path, size_t bytes) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none)) return {};
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
    if (!file) return {};
    std::string head(bytes, 0);
    const int got = gzread(file.get(), head.data(), unsigned(bytes));
    head.resize(got > 0 ? size_t(got) : 0);
    return head;
}

MeshCounts CountsOfPly(const std::string &path) {
    MeshCounts counts;
    std::istringstream lines(HeadOf(path, 1 << 16));
    for (std::string line; std::getline(lines, line) && !line.starts_with("end_header");) {
        std::istringstream words(line);
        std::string kind, name, last;
        double count = 0;
        words >> kind >> name;
        if (kind == "element" && words >> count && count > 0 && count < 1e12) {
            if (name == "vertex") counts.vertices = count;
            if (name == "face") counts.triangles = count;  // lower bound: a quad counts as one
        } else if (kind == "property" && words >> last) {
            if (last == "nx") counts.bytesPerVertex += sizeof(Normal3);
            if (last == "u" || last == "s") counts.bytesPerVertex += sizeof(Point2);
        }
    }
    return counts;
}

MeshCounts CountsOf(const ShapeEntity &shape, const FileResolver &files) {
    MeshCounts counts;
    const ParamSet &set = shape.params;
    const auto size = [&](const char *name, ParamType type) -> double {
        const Param *p = set.Find(name, type);
        return p ? double(p->floats.size() + p->ints.size()) : 0;
    };
    const bool isPatches = shape.type == "bilinearmesh";
    if (shape.type == "plymesh") {
        const Param *name = set.Find("filename", ParamType::String);
        if (name && name->strings.size() == 1) counts = CountsOfPly(files.Resolve(name->strings[0]));
    } else if (shape.type == "trianglemesh" || isPatches) {
        counts.vertices = size("P", ParamType::Point3) / 3;
        counts.triangles = size("indices", ParamType::Integer) / (isPatches ? 2 : 3);
        if (size("N", ParamType::Normal) > 0) counts.bytesPerVertex += sizeof(Normal3);
        if (size("uv", ParamType::Point2) > 0) counts.bytesPerVertex += sizeof(Point2);
    } else if (shape.type == "loopsubdiv") {
        const Param *levels = set.Find("levels", ParamType::Integer);
        const int n = levels && levels->ints.size() == 1 ? std::clamp(levels->ints[0], 0, 30) : 3;
        counts.triangles = size("indices", ParamType::Integer) / 3 * std::pow(4.0, n);
        counts.vertices = counts.triangles / 2;
        counts.bytesPerVertex += sizeof(Normal3);
    }
    return counts;
}

/// Lower bound of an image's pixel bytes.
double ImageBytes(const std::string &path) {
    const std::string head = HeadOf(path, 26);
    if (head.starts_with("\x89PNG") && head.size() == 26) {
        const auto number = [&](size_t at) {
            double value = 0;
            for (size_t i = at; i < at + 4; ++i) value = 256 * value + static_cast<unsigned char>(head[i]);
            return value;
        };
        const int depth = head[24], colors = head[25];
        const double channels = colors == 2 || colors == 3 ? 3 : colors == 6 ? 4 : colors == 4 ? 2 : 1;
        return number(16) * number(20) * channels * (depth == 16 ? 2 : 1);
    }
    std::error_code none;
    const auto size = std::filesystem::file_size(path, none);
    return none ? 0 : double(size);
}

void AddImages(const SceneDescription &d, MemoryEstimate *estimate) {
    std::set<std::string> seen;
    const auto add = [&](const Entity &entity, double factor) {
        const Param *name = entity.params.Find("filename", ParamType::String);
        if (!name || name->strings.size() != 1) return;
        const std::string path = d.files.Resolve(name->strings[0]);
        if (!seen.insert(path).second) return;
        const double bytes = factor * ImageBytes(path);
        estimate->Include(bytes, entity.loc);
        estimate->images += bytes;
        ++estimate->imageCount;
    };
    for (const TextureEntity &t : d.textures)
        if (t.type == "imagemap") add(t, 4.0 / 3);  // with MIP levels
    for (const LightEntity &l : d.lights) add(l, 1);
}

}  // namespace

MemoryEstimate EstimateMemory(const SceneDescription &d, double filmBytes, bool imagesInMemory) {
    MemoryEstimate estimate;
    estimate.film = filmBytes;
    const auto addShapes = [&](const std::vector<ShapeEntity> &shapes) {
        for (const ShapeEntity &shape : shapes) {
            const MeshCounts counts = CountsOf(shape, d.files);
            estimate.Include(counts.Bytes(), shape.loc);
            estimate.meshes += counts.Bytes();
            estimate.triangles += counts.triangles;
        }
    };
    addShapes(d.shapes);
    std::set<std::string> used;  // an object's shapes are built once, regardless of its number of instances
    for (const InstanceEntity &i : d.instances) used.insert(i.name);
    for (const ObjectEntity &o : d.objects)
        if (used.count(o.name)) addShapes(o.shapes);
    if (imagesInMemory) AddImages(d, &estimate);
    return estimate;
}

}  // namespace pbrt
