// Renders the conformance scenes and compares them with the references of stock pbrt-v4 (suite/README.md, "How to
// compare"). Prints one line a scene and "N passed, M failed". Options: --group g, --name n, --scale s (samples
// relative to the manifest), --write folder (EXRs of what was rendered).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "pbrt/core/parallel.h"
#include "support/render_scene.h"
#include "support/statistics.h"

namespace {

using namespace pbrt;
using namespace pbrt::test;

const std::string kFolder = std::string(PBRT_SOURCE_DIR) + "/tests/conformance/";
const std::string kSuite = kFolder + "suite/";

struct Record {
    std::string name, category, scene, referenceA, referenceB, compare;
    int spp = 0;

    std::string Label() const { return category + "/" + name; }
};

/// The line of a scene without figures.
void PrintVerdict(const Record &r, const std::string &verdict) {
    fmt::print("{:<44} {:>10} {:>9} {:>9} {:>7}  {}\n", r.Label(), "-", "-", "-", "-", verdict);
}

/// Lines "category/name" of a list file; '#' starts a comment.
std::set<std::string> ReadList(const std::string &file) {
    std::set<std::string> names;
    std::ifstream in(kFolder + file);
    for (std::string line; std::getline(in, line);) {
        line = line.substr(0, line.find('#'));
        line.erase(line.find_last_not_of(" \t") + 1);
        if (!line.empty()) names.insert(line);
    }
    return names;
}

/// The row-major indices of the tiles of `size` x `size` pixels of a scene that ambiguous.txt excludes from comparison.
std::set<int> AmbiguousTiles(const std::string &label, int size, int tilesX) {
    std::set<int> tiles;
    for (const std::string &line : ReadList("ambiguous.txt")) {
        std::istringstream in(line);
        std::string name;
        int x0, x1, y0, y1;
        in >> name >> x0 >> x1 >> y0 >> y1;
        if (name != label) continue;
        for (int y = y0 / size; y <= (y1 - 1) / size; ++y)
            for (int x = x0 / size; x <= (x1 - 1) / size; ++x) tiles.insert(y * tilesX + x);
    }
    return tiles;
}

/// By how much (relative, R, G, B) the image mean of a scene departs on purpose (departures.txt); empty if it does not.
std::vector<double> Departure(const std::string &label) {
    for (const std::string &line : ReadList("departures.txt")) {
        std::istringstream in(line);
        std::string name;
        std::vector<double> percent(3);
        in >> name >> percent[0] >> percent[1] >> percent[2];
        if (name == label && in) return {percent[0] / 100, percent[1] / 100, percent[2] / 100};
    }
    return {};
}

struct Verdict {
    bool good = true;
    std::array<double, 3> means{};  ///< relative difference of image means, per channel
    double difference = 0;          ///< relative RMS difference of tile means
    double noise = 0;               ///< expected from the noise of both sides
    double worstZ = 0;
    std::string why;

    double LargestMean() const {
        return *std::ranges::max_element(means, {}, [](double m) { return std::abs(m); });
    }
    void Fail(const std::string &reason) {
        good = false;
        why += (why.empty() ? "" : "; ") + reason;
    }
};

/// Tile means of three channels, row-major: of stock and of ours, each the mean of two renders, and the variance of
/// their difference.
class Tiles {
  public:
    Tiles(const std::array<std::vector<double>, 2> &stock, const std::array<std::vector<double>, 2> &ours, int tilesX,
          std::set<int> leftOut)
        : tilesX_(tilesX), leftOut_(std::move(leftOut)) {
        for (size_t i = 0; i < stock[0].size(); ++i) {
            stock_.push_back((stock[0][i] + stock[1][i]) / 2);
            ours_.push_back((ours[0][i] + ours[1][i]) / 2);
            variance_.push_back((Sqr(stock[0][i] - stock[1][i]) + Sqr(ours[0][i] - ours[1][i])) / 4);
        }
        for (size_t i = 0; i < stock_.size(); ++i)
            if (Counts(i)) overall_ += stock_[i] / double(Count());
    }

    Verdict Compare(const std::string &kind) const {
        Verdict v;
        CompareMeans(kind == "loose", &v);
        size_t beyond4 = 0;
        double sumDifference = 0, sumNoise = 0;
        for (size_t i = 0; i < stock_.size(); ++i) {
            if (!Counts(i)) continue;
            const double difference = ours_[i] - stock_[i];
            const double z = std::abs(difference) / std::sqrt(VarianceAround(i));
            v.worstZ = std::max(v.worstZ, z);
            beyond4 += z > 4;
            sumDifference += Sqr(difference);
            sumNoise += variance_[i];
        }
        v.difference = std::sqrt(sumDifference / double(Count())) / overall_;
        v.noise = std::sqrt(sumNoise / double(Count())) / overall_;
        if (kind == "tiles") {
            // The tile noise is estimated from two runs each, so single tiles have heavy tails: 1 in 100 may pass 4
            // sigma.
            if (double(beyond4) > std::max(3.0, 0.01 * double(Count())))
                v.Fail(fmt::format("{} of {} tile means beyond 4 sigma", beyond4, Count()));
            if (v.worstZ > 12) v.Fail(fmt::format("a tile at {:.1f} sigma", v.worstZ));
            if (v.difference > 2 * v.noise + 0.001) v.Fail("tile differences exceed twice the noise");
        } else if (v.difference > 2 * v.noise + 0.02) {
            v.Fail("tile differences exceed the noise");
        }
        return v;
    }

  private:
    bool Counts(size_t i) const { return !leftOut_.contains(int(i / 3)); }
    size_t Count() const { return stock_.size() - 3 * leftOut_.size(); }

    void CompareMeans(bool isLoose, Verdict *v) const {
        for (size_t k = 0; k < 3; ++k) {
            // Relative to the mean absolute value: colours outside sRGB cancel.
            double difference = 0, variance = 0, magnitude = 0;
            for (size_t i = k; i < stock_.size(); i += 3) {
                if (!Counts(i)) continue;
                difference += ours_[i] - stock_[i];
                variance += variance_[i];
                magnitude += std::abs(stock_[i]);
            }
            v->means[k] = difference / magnitude;
            const double relative = std::abs(v->means[k]), noise = std::sqrt(variance) / magnitude;
            if (relative > (isLoose ? 0.009 : 0.01))
                v->Fail(fmt::format("mean of channel {} off by {:.2f} %", k, 100 * v->means[k]));
            else if (!isLoose && relative > std::max(4 * noise, 0.003))
                v->Fail(fmt::format("mean of channel {} off by {:.2f} % (noise {:.2f} %)", k, 100 * v->means[k],
                                    100 * noise));
        }
    }

    /// Mean over the tiles around that of value i, and over the channels, with a floor.
    double VarianceAround(size_t i) const {
        const int tile = int(i / 3), tilesY = int(stock_.size()) / 3 / tilesX_;
        double sum = 0;
        int count = 0;
        for (int y = tile / tilesX_ - 1; y <= tile / tilesX_ + 1; ++y)
            for (int x = tile % tilesX_ - 1; x <= tile % tilesX_ + 1; ++x) {
                if (x < 0 || y < 0 || x >= tilesX_ || y >= tilesY) continue;
                for (int k = 0; k < 3; ++k) sum += variance_[size_t(y * tilesX_ + x) * 3 + k];
                count += 3;
            }
        return sum / count + Sqr(0.002 * stock_[i]) + Sqr(0.0005 * overall_);
    }

    int tilesX_;
    std::set<int> leftOut_;
    std::vector<double> stock_, ours_, variance_;
    double overall_ = 0;
};

/// The two references of stock pbrt-v4, and two renders of ours with other seeds.
struct Images {
    Image stock[2], ours[2];

    Tiles TilesOf(const std::vector<std::string> &channels, int tile, std::set<int> leftOut) const {
        const auto means = [&](const Image(&pair)[2]) {
            return std::array{TileMeans(pair[0].Select(channels), tile), TileMeans(pair[1].Select(channels), tile)};
        };
        return {means(stock), means(ours), TilesAcross(tile), std::move(leftOut)};
    }
    int TilesAcross(int tile) const { return (stock[0].Resolution().x + tile - 1) / tile; }
};

/// A channel of a gbuffer: of how many pixels the means differ much more than those of either side's two images is
/// limited, and variances must agree within a factor. "" if they do.
std::string CompareChannel(const std::string &name, const Images &images) {
    const Point2i size = images.stock[0].Resolution();
    double meanStock = 0, meanOurs = 0, magnitude = 0;
    int off = 0;
    ForEachPixel(images.stock[0], [&](Point2i p) {
        const auto at = [&](const Image &image) { return double(image.Get(p, image.FindChannel(name))); };
        const double s0 = at(images.stock[0]), s1 = at(images.stock[1]);
        const double o0 = at(images.ours[0]), o1 = at(images.ours[1]);
        const double stock = (s0 + s1) / 2, ours = (o0 + o1) / 2, noise = std::abs(s0 - s1) + std::abs(o0 - o1);
        meanStock += stock;
        meanOurs += ours;
        magnitude += std::abs(stock);
        off += std::abs(ours - stock) > 3 * noise + 0.02 * std::abs(stock) + 0.005;
    });
    if (name.find("ariance") != std::string::npos)
        return meanOurs < meanStock / 1.5 || meanOurs > meanStock * 1.5
                   ? fmt::format("{} is {:.2f} times the reference", name, meanOurs / meanStock)
                   : "";
    if (off > size.x * size.y / 50) return fmt::format("{} differs in {} of {} pixels", name, off, size.x * size.y);
    const bool isSlope = name.starts_with("dz");  // a few pixels along silhouettes hold most of the mean
    const double difference = std::abs(meanOurs - meanStock);
    return !isSlope && difference > 0.02 * magnitude
               ? fmt::format("mean of {} differs by {:.2f} %", name, 100 * difference / magnitude)
               : "";
}

/// Channels beyond R, G, B. Spectral buckets by the tile test, three at a time (the last ones twice if need be).
void CompareFurtherChannels(const Record &record, const Images &images, int tile, Verdict *v) {
    std::vector<std::string> buckets;
    for (const std::string &name : images.stock[0].Channels()) {
        if (name == "R" || name == "G" || name == "B") continue;
        if (images.ours[0].FindChannel(name) < 0) return v->Fail("no channel " + name);
        if (name.starts_with("S0.")) buckets.push_back(name);
        else if (const std::string why = CompareChannel(name, images); !why.empty()) v->Fail(why);
    }
    for (size_t i = 0; buckets.size() >= 3 && i < buckets.size(); i += 3) {
        const auto first = buckets.begin() + std::ptrdiff_t(std::min(i, buckets.size() - 3));
        const std::vector<std::string> names(first, first + 3);
        const Verdict of = images.TilesOf(names, tile, {}).Compare(record.compare);
        if (!of.good) v->Fail(fmt::format("{} to {}: {}", names.front(), names.back(), of.why));
    }
}

struct Options {
    std::string group, name, write;
    double scale = 0.25;

    bool Parse(int argc, char **argv) {
        for (int i = 1; i < argc; i += 2) {
            const std::string flag = i + 1 < argc ? argv[i] : "";
            if (flag == "--group") group = argv[i + 1];
            else if (flag == "--name") name = argv[i + 1];
            else if (flag == "--scale") scale = std::atof(argv[i + 1]);
            else if (flag == "--write") write = argv[i + 1];
            else return false;
        }
        return true;
    }
    bool Select(const Record &r) const {
        return (group.empty() || r.category == group) && (name.empty() || r.name == name);
    }
};

Images Render(const Record &r, double scale) {
    RenderRequest request;
    request.file = kSuite + r.scene;
    // Scenes with a fixed sample count keep it; texture footprints stop shrinking at 64 samples, and the blur of
    // photons depends on the number of iterations.
    const bool isFixed = r.compare == "mean" || r.name == "imagemap_filters" || r.name == "sppm";
    // Of mlt the reference has most of the noise.
    const double share = r.name == "mlt" ? scale / 3 : scale;
    request.build.samplesPerPixel = isFixed ? r.spp : std::max(64, int(r.spp * share));
    Images images;
    for (int i = 0; i < 2; ++i) {
        request.build.seed = 100 + i;
        images.ours[i] = RenderScene(request).image;
        images.stock[i] = ReadImage(kSuite + (i == 0 ? r.referenceA : r.referenceB)).image;
    }
    return images;
}

/// Prints the scene's line. True if it agrees with stock, or departs as departures.txt says.
bool CompareScene(const Record &r, const Images &images) {
    const Point2i size = images.ours[0].Resolution(), wanted = images.stock[0].Resolution();
    if (size != wanted) {
        PrintVerdict(r, fmt::format("FAIL: size {}x{}, reference {}x{}", size.x, size.y, wanted.x, wanted.y));
        return false;
    }
    const int tile = r.compare == "mean" ? 16 : 8;
    const std::set<int> ambiguous = AmbiguousTiles(r.Label(), tile, images.TilesAcross(tile));
    Verdict v = images.TilesOf({"R", "G", "B"}, tile, ambiguous).Compare(r.compare);
    if (images.stock[0].ChannelCount() > 3) CompareFurtherChannels(r, images, tile, &v);
    std::string text = v.good ? "ok" : "FAIL: " + v.why;
    bool good = v.good;
    if (const std::vector<double> departure = Departure(r.Label()); !departure.empty()) {
        good = std::ranges::equal(v.means, departure, [](double a, double b) { return std::abs(a - b) < 0.005; });
        text = good ? "ok (departs as in departures.txt)"
                    : fmt::format("FAIL: departures.txt has other means: {:.2f}, {:.2f}, {:.2f} %", 100 * v.means[0],
                                  100 * v.means[1], 100 * v.means[2]);
    }
    fmt::print("{:<44} {:>9.3f}% {:>8.3f}% {:>8.3f}% {:>7.1f}  {}\n", r.Label(), 100 * v.difference, 100 * v.noise,
               100 * v.LargestMean(), v.worstZ, text);
    return good;
}

bool TestScene(const Record &r, const Options &options, bool isUnsupported) {
    try {
        const Images images = Render(r, options.scale);
        if (isUnsupported) {
            PrintVerdict(r, "FAIL: it renders, but not_supported.txt lists it");
            return false;
        }
        if (!options.write.empty())
            WriteImage(options.write + "/" + r.category + "_" + r.name + ".exr", images.ours[0]);
        return CompareScene(r, images);
    } catch (const UserError &e) {
        // The whole message is printed only if it is unexpected.
        const std::string message = FormatAll(e);
        const bool good = isUnsupported && message.find("not supported yet") != std::string::npos;
        PrintVerdict(r, good ? "ok (an error: not supported)" : fmt::format("FAIL:\n{}", message));
        return good;
    }
}

}  // namespace

int main(int argc, char **argv) {
    Options options;
    if (!options.Parse(argc, argv)) {
        fmt::print(stderr, "usage: conformance [--group g] [--name n] [--scale s] [--write folder]\n");
        return 2;
    }
    ThreadLimit threads(0);
    const std::set<std::string> unsupported = ReadList("not_supported.txt");
    int passed = 0, failed = 0;
    fmt::print("{:<44} {:>10} {:>9} {:>9} {:>7}  {}\n", "scene", "difference", "noise", "mean", "worst z", "verdict");
    for (const auto &entry : nlohmann::json::parse(std::ifstream(kSuite + "manifest.json"))) {
        if (!entry.contains("reference")) continue;
        const Record r{entry["name"],       entry["category"], entry["scene"], entry["reference"],
                       entry["referenceB"], entry["compare"],  entry["spp"]};
        if (!options.Select(r)) continue;
        ++(TestScene(r, options, unsupported.contains(r.Label())) ? passed : failed);
        std::fflush(stdout);
    }
    fmt::print("{} passed, {} failed\n", passed, failed);
    return failed == 0 && passed > 0 ? 0 : 1;
}
