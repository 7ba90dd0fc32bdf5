// One law for every kind of area light and every light sampler: BSDF sampling alone, light sampling alone and both
// together have the same mean. Prints a table, also to <build>/tables/emitters.txt.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "emitter_kinds.h"
#include "estimators.h"
#include "pbrt/core/error.h"
#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace pbrt::test {
namespace {

constexpr double kAlpha = 1e-3;  ///< false alarm anywhere in the law's table, if the seeds were not fixed
constexpr int kSamples = 32, kRuns = 2, kReferenceSamples = 256;

/// Lines of the tables, on standard output at once and in <build>/tables/emitters.txt at the end.
class Tables : public testing::Environment {
  public:
    static void Line(const std::string &line) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
        Lines().push_back(line);
    }
    void TearDown() override {
        if (Lines().empty()) return;
        std::filesystem::path folder = std::filesystem::path(PBRT_BINARY_DIR) / "tables";
        std::filesystem::create_directories(folder);
        std::ofstream out(folder / "emitters.txt");
        for (const std::string &line : Lines()) out << line << "\n";
    }

  private:
    static std::vector<std::string> &Lines() {
        static std::vector<std::string> lines;
        return lines;
    }
};
const auto *const kTables = testing::AddGlobalTestEnvironment(new Tables);

/// One line: what it is about, a ratio of means per column, and what broke.
class Row {
  public:
    explicit Row(const std::string &name) : text_(fmt::format("{:<40}", name)) {}
    void Add(const std::string &column, const Agreement &a) {
        text_ += fmt::format("{:>8.3f}", 1 + a.difference);
        worstError_ = std::max(worstError_, a.error);
        if (!a.Agrees()) broken_ += fmt::format(" {} (p {:.1e}, {})", column, a.worstP, a.worst);
    }
    void Skip() { text_ += fmt::format("{:>8}", "-"); }
    bool Holds() const { return broken_.empty(); }
    std::string Text() const {
        return fmt::format("{} {:>6.3f}  {}", text_, worstError_, Holds() ? "holds" : "BROKEN:" + broken_);
    }

  private:
    std::string text_, broken_;
    double worstError_ = 0;
};

std::string Header(const std::string &what, const std::vector<std::string> &columns) {
    std::string line = fmt::format("{:<40}", what);
    for (const std::string &c : columns) line += fmt::format("{:>8}", c.size() > 7 ? c.substr(0, 7) : c);
    return line + fmt::format(" {:>6}  verdict", "+-");
}

TEST(EmittersKeepTheLaw, AllKindsAndSamplers) {
    const std::vector<EmitterKind> kinds = EmitterKinds();
    const std::vector<std::string> samplers = SamplerLabels(false);
    size_t comparisons = 0;
    for (const EmitterKind &kind : kinds) comparisons += 1 + 2 * SamplerLabels(kind.isMesh).size();

    Tables::Line("Means of light sampling alone (l) and of both together (b), per light sampler, over the mean of BSDF "
                 "sampling alone");
    std::vector<std::string> columns = {"simple"};
    for (const std::string &s : samplers)
        for (const char *way : {"l ", "b "}) columns.push_back(way + s);
    Tables::Line(Header("emitter", columns));
    int seed = 1;
    for (const EmitterKind &kind : kinds) {
        Studio studio(BuildText(SceneText(kind)));
        auto render = [&](Estimator e, const std::string &sampler, int samples) {
            return studio.Render(e, sampler, samples, kRuns, std::exchange(seed, seed + kRuns));
        };
        // Rays do not see a light of alpha 0: then the samples of "simplepath" are what the others are compared with.
        const PixelStatistics reference =
            render(kind.isSeen ? Estimator::Bsdf : Estimator::Lights, "", kind.isSeen ? kReferenceSamples : 2 * kSamples);
        Row row(kind.name);
        auto compare = [&](const std::string &column, const PixelStatistics &s) {
            row.Add(column, Compare(s, {&reference}, comparisons, kAlpha));
        };
        compare("simple", render(Estimator::Lights, "", kSamples));
        for (const std::string &s : samplers) {
            compare("l " + s, render(Estimator::Chosen, s, kSamples));
            compare("b " + s, render(Estimator::Both, s, kSamples));
        }
        Tables::Line(row.Text());
        EXPECT_TRUE(row.Holds()) << kind.name;
        if (!kind.isMesh) continue;
        Row grouped(kind.name + ", +meshlights");
        grouped.Skip();
        for (const std::string &s : samplers) {
            const std::string label = s + "+meshlights";
            const std::vector<std::string> all = SamplerLabels(true);
            if (!std::count(all.begin(), all.end(), label)) {
                grouped.Skip();
                grouped.Skip();
                continue;
            }
            grouped.Add("l " + label, Compare(render(Estimator::Chosen, label, kSamples), {&reference}, comparisons, kAlpha));
            grouped.Add("b " + label, Compare(render(Estimator::Both, label, kSamples), {&reference}, comparisons, kAlpha));
        }
        Tables::Line(grouped.Text());
        EXPECT_TRUE(grouped.Holds()) << kind.name;
    }
}

}  // namespace
}  // namespace pbrt::test
