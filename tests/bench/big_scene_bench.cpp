// How fast a big scene is read: makes one in a temporary folder (5,000 meshes, most in PLY files, the rest as text;
// 2 million triangles; 20,000 instances), reads, builds and renders it once, and prints how long that took.
//
//   bench_big_scene [scale [threads [folder]]]     scale: 1 is the above; folder: keep the scene there
//
// Prints JSON.
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pbrt/build/built_scene.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/rng.h"
#include "pbrt/scenefile/parser.h"
#include "plugins.h"

namespace pbrt {
namespace {

double Now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

rusage Usage() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage;
}

double PeakBytes() { return double(Usage().ru_maxrss) * 1024; }

/// CPU seconds of all threads: the time that a single, otherwise idle core would take.
double CpuSeconds() {
    const rusage usage = Usage();
    auto seconds = [](const timeval &t) { return double(t.tv_sec) + double(t.tv_usec) * 1e-6; };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Moment {
    double wall = Now(), cpu = CpuSeconds(), peak = PeakBytes();
};

/// A wavy patch of 2 * side * side triangles with normals and uv.
struct Patch {
    static constexpr int side = 14;
    std::vector<Float> p, n, uv;
    std::vector<int> indices;

    explicit Patch(Rng &rng) {
        const Point3 corner(rng.Uniform() * 100, rng.Uniform() * 100, rng.Uniform() * 100);
        const Float phase = rng.Uniform() * 6;
        for (int y = 0; y <= side; ++y)
            for (int x = 0; x <= side; ++x) {
                const Float u = Float(x) / side, v = Float(y) / side;
                const Point3 at = corner + Point3(u, v, Float(0.1) * std::sin(7 * u + phase));
                const Normal3 up = Normalize(Normal3(-Float(0.7) * std::cos(7 * u + phase), 0, 1));
                p.insert(p.end(), {at.x, at.y, at.z});
                n.insert(n.end(), {up.x, up.y, up.z});
                uv.insert(uv.end(), {u, v});
            }
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const int i = y * (side + 1) + x;
                indices.insert(indices.end(), {i, i + 1, i + side + 2, i, i + side + 2, i + side + 1});
            }
    }
};

template <class T>
void WriteList(std::ofstream &out, const char *declaration, const std::vector<T> &values) {
    std::string text = fmt::format(" \"{}\" [", declaration);
    for (const T &v : values) fmt::format_to(std::back_inserter(text), " {}", v);
    out << text << " ]\n";
}

void WritePly(const std::filesystem::path &file, const Patch &patch) {
    const size_t vertices = patch.p.size() / 3, faces = patch.indices.size() / 3;
    std::ofstream out(file, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << vertices
        << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
           "property float nz\nproperty float u\nproperty float v\nelement face "
        << faces << "\nproperty list uchar int vertex_indices\nend_header\n";
    auto put = [&](const auto *values, size_t count) {
        out.write(reinterpret_cast<const char *>(values), std::streamsize(count * sizeof(*values)));
    };
    for (size_t i = 0; i < vertices; ++i) {
        put(&patch.p[3 * i], 3);
        put(&patch.n[3 * i], 3);
        put(&patch.uv[2 * i], 2);
    }
    for (size_t i = 0; i < faces; ++i) {
        out.put(3);
        put(&patch.indices[3 * i], 3);
    }
}

struct Sizes {
    double textBytes = 0, plyBytes = 0, triangles = 0;
    int meshes = 0, instances = 0;
};

Sizes WriteScene(const std::filesystem::path &folder, double scale) {
    Sizes sizes;
    sizes.meshes = int(5000 * scale);
    sizes.instances = int(20000 * scale);
    std::filesystem::create_directories(folder / "ply");
    std::ofstream scene(folder / "scene.pbrt");
    scene << "LookAt 50 50 -200  50 50 50  0 1 0\nCamera \"perspective\" \"float fov\" 45\n"
             "Film \"rgb\" \"integer xresolution\" 128 \"integer yresolution\" 128 \"string filename\" \"big.exr\"\n"
             "Sampler \"independent\" \"integer pixelsamples\" 1\nWorldBegin\nLightSource \"infinite\"\n";
    // A tenth of the meshes are objects that are placed again and again; every fifth mesh is text.
    Rng rng(1);
    const int objects = std::max(1, sizes.meshes / 10);
    for (int i = 0; i < sizes.meshes; ++i) {
        const Patch patch(rng);
        sizes.triangles += double(patch.indices.size()) / 3;
        if (i % 10 == 0)
            scene << fmt::format("Material \"diffuse\" \"rgb reflectance\" [ {:.3f} {:.3f} {:.3f} ]\n", rng.Uniform(),
                                 rng.Uniform(), rng.Uniform());
        if (i < objects) scene << "ObjectBegin \"object " << i << "\"\n";
        if (i % 5 == 0) {
            scene << "Shape \"trianglemesh\"";
            WriteList(scene, "point3 P", patch.p);
            WriteList(scene, "normal N", patch.n);
            WriteList(scene, "point2 uv", patch.uv);
            WriteList(scene, "integer indices", patch.indices);
        } else {
            const std::string name = fmt::format("ply/mesh{:05}.ply", i);
            WritePly(folder / name, patch);
            sizes.plyBytes += double(std::filesystem::file_size(folder / name));
            scene << "Shape \"plymesh\" \"string filename\" \"" << name << "\"\n";
        }
        if (i < objects) scene << "ObjectEnd\n";
    }
    for (int i = 0; i < sizes.instances; ++i)
        scene << fmt::format(
            "AttributeBegin\nTranslate {} {} {}\nRotate {} 0 1 0\nObjectInstance \"object {}\"\nAttributeEnd\n",
            rng.Uniform() * 50, rng.Uniform() * 50, rng.Uniform() * 50, rng.Uniform() * 20, i % objects);
    scene.close();
    sizes.textBytes = double(std::filesystem::file_size(folder / "scene.pbrt"));
    return sizes;
}

void Run(double scale, const std::filesystem::path &folder) {
    const Sizes sizes = WriteScene(folder, scale);
    PluginRegistry registry;
    RegisterPlugins(registry);
    const Moment start;
    DiagnosticSink sink;
    SceneDescription description = ParseSceneFiles({folder / "scene.pbrt"}, sink);
    const Moment parsed;
    Progress progress;
    BuiltScene built = BuildScene(description, {}, registry, sink, progress);
    description = {};
    const Moment done;
    built.Prepare(progress);
    RenderSettings settings;
    settings.samplesPerPixel = 1;
    RenderWaves(built.Rendering(progress), settings);
    const Moment rendered;

    nlohmann::ordered_json out;
    out["meshes"] = sizes.meshes;
    out["triangles"] = sizes.triangles;
    out["instances"] = sizes.instances;
    out["threads"] = ThreadCount();
    out["textMegabytes"] = sizes.textBytes / 1e6;
    out["plyMegabytes"] = sizes.plyBytes / 1e6;
    out["parseSeconds"] = parsed.wall - start.wall;
    out["parseCpuSeconds"] = parsed.cpu - start.cpu;
    out["textMegabytesPerSecond"] = sizes.textBytes / 1e6 / (parsed.wall - start.wall);
    out["textMegabytesPerCpuSecond"] = sizes.textBytes / 1e6 / (parsed.cpu - start.cpu);
    out["buildSeconds"] = done.wall - parsed.wall;
    out["buildCpuSeconds"] = done.cpu - parsed.cpu;
    out["trianglesPerSecond"] = sizes.triangles / (done.wall - start.wall);
    out["trianglesPerCpuSecond"] = sizes.triangles / (done.cpu - start.cpu);
    out["secondsToFirstPixels"] = rendered.wall - start.wall;
    out["cpuSecondsToFirstPixels"] = rendered.cpu - start.cpu;
    out["peakBytesPerTriangle"] = (rendered.peak - start.peak) / sizes.triangles;
    out["accelBytesPerTriangle"] = double(built.scene->Acceleration().Bytes()) / sizes.triangles;
    std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace
}  // namespace pbrt

int main(int argc, char **argv) {
    const double scale = argc > 1 ? std::atof(argv[1]) : 1;
    pbrt::ThreadLimit limit(argc > 2 ? std::atoi(argv[2]) : 0);
    const bool keep = argc > 3;
    const std::filesystem::path folder =
        keep ? std::filesystem::path(argv[3])
             : std::filesystem::temp_directory_path() / ("pbrt_big_scene_" + std::to_string(getpid()));
    try {
        std::filesystem::create_directories(folder);
        pbrt::Run(scale, folder);
    } catch (const pbrt::UserError &e) {
        for (const pbrt::Diagnostic &d : e.Diagnostics()) std::fprintf(stderr, "%s\n", pbrt::Format(d).c_str());
        return 1;
    }
    if (!keep) std::filesystem::remove_all(folder);
    return 0;
}
