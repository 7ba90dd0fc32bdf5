// In every scene of scenes/ (whatever is there) the octree can choose each light that an exhaustive search finds to
// contribute. Only lights whose PMF is zero are searched, because only they could break the law.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "pbrt/math/rng.h"
#include "scene_fixtures.h"
#include "support/test_name.h"
#include "support/wrapped_sampler.h"

namespace pbrt::test {
namespace {

/// What the checks of one sampler in one scene found.
struct Findings {
    size_t zeros = 0;         ///< pairs of place and light whose PMF is zero
    size_t searched = 0;      ///< those of them that were searched
    size_t contributing = 0;  ///< draws of the sampler that found light
    std::vector<std::string> wrong;
};

/// The number of light points for all zero pairs of a sampler together, and its limits for a single pair.
constexpr size_t kSearch = 1200000, kMaxPoints = 512, kMinPoints = 6;
constexpr int kDraws = 32;

/// Whether the light is chosen by regions at the place.
bool IsDivided(const SceneFixture &f, const LightDistribution &at, LightId light) {
    return f.Lights()[light].Kind() == LightKind::Infinite &&
           at.Towards(light, at.Query().p, Vector3(0, 0, 1)).region.portals;
}

/// The first contribution that is not 0 among `points` light points of a light, seen from a place; 0 if there is none.
/// An environment light may be chosen by regions: then a contribution counts if the region in its direction has the PMF
/// 0. Directions are drawn as if there were no BSDF sampling, because regions are sampled so.
double SearchLight(const SceneFixture &f, const LightSampler &sampler, size_t place, LightId light, size_t points,
                   uint64_t seed) {
    Rng rng(Hash(place, light.value, seed));
    LightMemory memory;
    const LightDistribution at = sampler.At(f.queries[place], memory);
    const Point3 &p = f.queries[place].p;
    const bool isInfinite = f.Lights()[light].Kind() == LightKind::Infinite, isDivided = IsDivided(f, at, light);
    for (size_t k = 0; k < points; ++k) {
        Vector3 wi;
        const double c =
            Contribution(*f.built.scene, f.queries[place], f.Lights()[light], rng.Uniform2(), &wi, !isDivided);
        if (!(c > 0)) continue;
        if (!((isInfinite ? at.Towards(light, p, wi).pmf : at.PMF(light)) > 0)) return c;
    }
    return 0;
}

void SearchZeros(const SceneFixture &f, const LightSampler &sampler, uint64_t seed, bool endsAtFirst, Findings *out) {
    std::vector<std::pair<size_t, LightId>> zeros;
    LightMemory memory;
    for (size_t q = 0; q < f.queries.size(); ++q) {
        const LightDistribution at = sampler.At(f.queries[q], memory);
        for (size_t l = 0; l < f.Lights().Size(); ++l)
            if (!(at.PMF(LightId(l)) > 0) || IsDivided(f, at, LightId(l))) zeros.emplace_back(q, LightId(l));
    }
    out->zeros = zeros.size();
    if (zeros.empty()) return;
    const size_t points = std::clamp(kSearch / zeros.size(), kMinPoints, kMaxPoints);
    const double share = double(kSearch) / double(points * zeros.size());
    for (auto [q, light] : zeros) {
        if (endsAtFirst && !out->wrong.empty()) return;
        if (double(HashFloat(q, light.value, seed)) >= share) continue;
        ++out->searched;
        if (double c = SearchLight(f, sampler, q, light, points, seed); c > 0)
            out->wrong.push_back(fmt::format("place {}: light {} contributes {} and has PMF 0", q, light.value, c));
    }
}

void Draw(const SceneFixture &f, const LightSampler &sampler, Findings *out) {
    Rng rng(5);
    for (size_t q = 0; q < f.queries.size(); ++q)
        for (int i = 0; i < kDraws; ++i) {
            std::optional<SampledLight> s = sampler.Sample(f.queries[q], rng.Uniform());
            if (!s) continue;
            Float pmf = sampler.PMF(f.queries[q], s->light);
            // Regions have a part of the light's probability (CheckRegions).
            if ((s->region.portals ? s->pmf > pmf : s->pmf != pmf) || !(s->pmf > 0))
                out->wrong.push_back(
                    fmt::format("place {}: light {} drawn with {}, PMF {}", q, s->light.value, s->pmf, pmf));
            const LightComponent light = f.Lights().Region(s->light, s->region);
            out->contributing += Contribution(*f.built.scene, f.queries[q], light, rng.Uniform2()) > 0;
        }
}

/// Different seeds test different points. `endsAtFirst`: the search ends at the first light that is wrong.
Findings Check(const SceneFixture &f, const LightSampler &sampler, uint64_t seed, bool endsAtFirst = false) {
    Findings out;
    Draw(f, sampler, &out);
    SearchZeros(f, sampler, seed, endsAtFirst, &out);
    return out;
}

std::vector<std::string> SceneFiles() {
    std::vector<std::string> files;
    for (const auto &entry : std::filesystem::recursive_directory_iterator(std::string(PBRT_SOURCE_DIR) + "/scenes"))
        if (entry.path().extension() == ".pbrt") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

/// A scene with a tiny picture, and places in it.
std::unique_ptr<SceneFixture> MakeFixture(const std::string &file) {
    auto fixture = std::make_unique<SceneFixture>();
    BuildOptions options;
    options.film.resolutionDivisor = 12;
    options.lightSampler = "uniform";  // for the integrator, which renders nothing
    fixture->built = BuildFile(file, options);
    fixture->queries = Places(fixture->built, 40, 4, 1, fixture->bsdfs);
    return fixture;
}

std::string SceneName(const std::string &file) { return TestName(std::filesystem::path(file).stem().string()); }

/// Scenes whose lights reach few places: a sky through a hole, a door that is ajar for a moment, a far window, or
/// lights only through glass, which shadow rays do not pass.
bool HardlyLit(const std::string &file) {
    const std::string name = SceneName(file);
    return name == "keyhole" || name == "moving_door" || name == "pane" || name == "bathroom" ||
           name.starts_with("corridor");
}

/// Check notices that `sampler` never chooses the light whose draws find light most often.
void ExpectALightLeftOutIsNoticed(const SceneFixture &f, std::unique_ptr<LightSampler> sampler) {
    std::vector<int> found(f.Lights().Size(), 0);
    Rng rng(3);
    for (const LightQuery &q : f.queries)
        for (int i = 0; i < kDraws; ++i)
            if (std::optional<SampledLight> s = sampler->Sample(q, rng.Uniform()))
                found[s->light.value] +=
                    Contribution(*f.built.scene, q, f.Lights().Region(s->light, s->region), rng.Uniform2()) > 0;
    const LightId most(uint32_t(std::max_element(found.begin(), found.end()) - found.begin()));
    const TamperedSampler without(
        std::move(sampler), [&](const LightQuery &, const SampledLight &s) { return s.light == most ? 0 : s.pmf; });
    EXPECT_GT(Check(f, without, 0, true).wrong.size(), 0u) << "light " << most.value;
}

class SceneFile : public testing::TestWithParam<std::string> {};

TEST_P(SceneFile, OctreeCanChooseEveryLightThatContributes) {
    const std::unique_ptr<SceneFixture> fixture = MakeFixture(GetParam());
    const SceneFixture &f = *fixture;
    ASSERT_GT(f.Lights().Size(), 0u);
    uint64_t seed = 0;
    // With a small budget, with a large one, and as published.
    for (const std::string label : {"octree", "octree:prepassspp=2", "octree:meshlights=false", "octree:model=paper"}) {
        std::unique_ptr<LightSampler> sampler = MakePreparedSampler(label, f);
        Findings found = Check(f, *sampler, ++seed);
        for (size_t i = 0; i < std::min<size_t>(found.wrong.size(), 10); ++i)
            ADD_FAILURE() << label << ", " << found.wrong[i];
        EXPECT_EQ(found.wrong.size(), 0u) << label;
        std::printf(
            "%s: %zu lights, %zu places, PMF 0: %zu, of which searched %zu; draws that find light: %zu of %zu\n",
            label.c_str(), f.Lights().Size(), f.queries.size(), found.zeros, found.searched, found.contributing,
            f.queries.size() * size_t(kDraws));
        if (HardlyLit(GetParam())) continue;
        EXPECT_GT(found.contributing, f.queries.size() / 4) << label << ": these places test nothing.";
        if (label == "octree") ExpectALightLeftOutIsNoticed(f, std::move(sampler));
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneFile, testing::ValuesIn(SceneFiles()),
                         [](const auto &c) { return SceneName(c.param); });

TEST(SceneFiles, AreListed) { EXPECT_GE(SceneFiles().size(), 14u); }

}  // namespace
}  // namespace pbrt::test
