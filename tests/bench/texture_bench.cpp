// Look-ups of one image by our pyramid, in memory and in the tile cache, and by OpenImageIO's texture system, on one
// thread, at random positions.
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "pbrt/images/mipmap.h"

namespace {

using namespace pbrt;

constexpr int Size = 1024;
constexpr size_t QueryCount = 1 << 14;

// A smooth picture with some noise, as an 8-bit PNG.
class TestImage {
  public:
    TestImage() {
        path_ = (std::filesystem::temp_directory_path() / ("pbrt_texture_bench_" + std::to_string(getpid()) + ".png"))
                    .string();
        Image image(PixelFormat::U8, {Size, Size}, {"R", "G", "B"});
        std::mt19937 rng(1);
        for (int y = 0; y < Size; ++y)
            for (int x = 0; x < Size; ++x)
                for (int c = 0; c < 3; ++c)
                    image.Set({x, y}, c,
                              0.3f + 0.2f * std::sin(Float(x + c * y) * 0.01f) + 0.2f * Float(rng() & 255) / 255);
        WriteImage(path_, image);
    }
    ~TestImage() { std::filesystem::remove(path_); }
    const std::string &Path() const { return path_; }

  private:
    std::string path_;
};

const TestImage &Picture() {
    static const TestImage picture;
    return picture;
}

struct Query {
    Point2 st;
    Vector2 dst0, dst1;
};

// Footprints of `texels` texels; positions anywhere (coherence 0) or in a walk of small steps, as along image rows.
std::vector<Query> Queries(Float texels, bool coherent) {
    std::mt19937 rng(2);
    std::uniform_real_distribution<Float> uniform(0, 1);
    std::vector<Query> queries(QueryCount);
    Point2 at(0.5f, 0.5f);
    for (Query &q : queries) {
        if (coherent) at = glm::fract(at + Vector2(uniform(rng) * 4 / Size, uniform(rng) * 0.5f / Size));
        else at = {uniform(rng), uniform(rng)};
        const Float angle = uniform(rng) * 2 * Pi, length = texels / Size;
        q.st = at;
        q.dst0 = length * Vector2(std::cos(angle), std::sin(angle));
        q.dst1 = length * Vector2(-std::sin(angle), std::cos(angle));
    }
    return queries;
}

void OurLookup(benchmark::State &state, TextureFilter filter, bool tiled = false) {
    TileCache tiles(1024);
    const MipMap map(ReadImage(Picture().Path()).image, nullptr, filter, WrapMode::Repeat, 8, tiled ? &tiles : nullptr);
    const std::vector<Query> queries = Queries(Float(state.range(0)) / 4, state.range(1) != 0);
    size_t i = 0;
    for (auto _ : state) {
        const Query &q = queries[i++ & (QueryCount - 1)];
        benchmark::DoNotOptimize(map.LookupRgb(q.st, q.dst0, q.dst1));
    }
}

void OiioLookup(benchmark::State &state, OIIO::TextureOpt::InterpMode interpolation, OIIO::TextureOpt::MipMode mip) {
    OIIO::TextureSystem *system = OIIO::TextureSystem::create(false);
    system->attribute("automip", 1);
    system->attribute("autotile", 64);
    system->attribute("max_memory_MB", 1024.f);
    OIIO::TextureSystem::Perthread *thread = system->get_perthread_info();
    OIIO::TextureSystem::TextureHandle *handle = system->get_texture_handle(OIIO::ustring(Picture().Path()), thread);
    OIIO::TextureOpt options;
    options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
    options.interpmode = interpolation;
    options.mipmode = mip;
    options.anisotropic = 8;
    const std::vector<Query> queries = Queries(Float(state.range(0)) / 4, state.range(1) != 0);
    auto look = [&](const Query &q) {
        float result[3] = {0, 0, 0};
        const bool ok =
            system->texture(handle, thread, options, q.st.x, q.st.y, q.dst0.x, q.dst0.y, q.dst1.x, q.dst1.y, 3, result);
        benchmark::DoNotOptimize(result);
        return ok;
    };
    // Loads the tiles first, so that files are read outside the measurement.
    for (const Query &q : queries)
        if (!look(q)) {
            state.SkipWithError(system->geterror().c_str());
            break;
        }
    size_t i = 0;
    for (auto _ : state) look(queries[i++ & (QueryCount - 1)]);
    OIIO::TextureSystem::destroy(system);
}

// Arguments: footprint in quarters of a texel, coherent.
void Footprints(benchmark::internal::Benchmark *b) {
    for (int coherent : {0, 1})
        for (int quarterTexels : {1, 16}) b->Args({quarterTexels, coherent});
    b->ArgNames({"quarter_texels", "coherent"});
}

void TiledLookup(benchmark::State &state, TextureFilter filter) { OurLookup(state, filter, true); }

using Opt = OIIO::TextureOpt;
BENCHMARK_CAPTURE(OurLookup, bilinear, TextureFilter::Bilinear)->Apply(Footprints);
BENCHMARK_CAPTURE(TiledLookup, bilinear, TextureFilter::Bilinear)->Apply(Footprints);
BENCHMARK_CAPTURE(OiioLookup, bilinear, Opt::InterpBilinear, Opt::MipModeOneLevel)->Apply(Footprints);
BENCHMARK_CAPTURE(OurLookup, trilinear, TextureFilter::Trilinear)->Apply(Footprints);
BENCHMARK_CAPTURE(TiledLookup, trilinear, TextureFilter::Trilinear)->Apply(Footprints);
BENCHMARK_CAPTURE(OiioLookup, trilinear, Opt::InterpBilinear, Opt::MipModeTrilinear)->Apply(Footprints);
BENCHMARK_CAPTURE(OurLookup, ewa, TextureFilter::Ewa)->Apply(Footprints);
BENCHMARK_CAPTURE(TiledLookup, ewa, TextureFilter::Ewa)->Apply(Footprints);
BENCHMARK_CAPTURE(OiioLookup, anisotropic, Opt::InterpBilinear, Opt::MipModeAniso)->Apply(Footprints);

}  // namespace

BENCHMARK_MAIN();
