// Renders the conformance scenes and compares them with the references of stock pbrt-v4 (suite/README.md, "How to
// compare"). Prints one line a scene and "N passed, M failed". Options: --group g, --name n, --scale s (samples
// relative to the manifest), --write folder (EXRs of what was rendered).
#include <fmt/format.h>

#include <fstream>
#include <map>
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
};

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
    double means[3] = {};   ///< relative difference of image means, all channels
    double difference = 0;  ///< relative RMS difference of tile means
    double noise = 0;       ///< expected from the noise of both sides
    double mean = 0;        ///< relative difference of image means, largest channel
    double worstZ = 0;
    std::string why;
};

Verdict Compare(const Record &record, const std::vector<double> &a, const std::vector<double> &b,
                const std::vector<double> &c1, const std::vector<double> &c2, int tilesX,
                const std::set<int> &leftOut) {
    Verdict v;
    const size_t all = a.size(), n = all - 3 * leftOut.size();
    const int tilesY = static_cast<int>(all) / 3 / tilesX;
    auto counts = [&](size_t i) { return !leftOut.count(static_cast<int>(i / 3)); };
    double meanReference[3] = {}, meanCandidate[3] = {}, errorOfMean[3] = {}, magnitude[3] = {};
    std::vector<double> variance(all), r(all), c(all);
    double overall = 0;
    for (size_t i = 0; i < all; ++i) {
        r[i] = (a[i] + b[i]) / 2;
        c[i] = (c1[i] + c2[i]) / 2;
        variance[i] = (a[i] - b[i]) * (a[i] - b[i]) / 4 + (c1[i] - c2[i]) * (c1[i] - c2[i]) / 4;
        if (!counts(i)) continue;
        meanReference[i % 3] += r[i];
        magnitude[i % 3] +=
            std::abs(r[i]);  // what the channel's difference is relative to: colours outside sRGB cancel
        meanCandidate[i % 3] += c[i];
        errorOfMean[i % 3] += variance[i];
        overall += r[i] / static_cast<double>(n);
    }
    double sumDifference = 0, sumNoise = 0;
    size_t beyond4 = 0;
    for (int y = 0; y < tilesY; ++y)
        for (int x = 0; x < tilesX; ++x)
            for (int k = 0; k < 3; ++k) {
                double around = 0;
                int count = 0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        int xx = x + dx, yy = y + dy;
                        if (xx < 0 || yy < 0 || xx >= tilesX || yy >= tilesY) continue;
                        for (int kk = 0; kk < 3; ++kk)
                            around += variance[static_cast<size_t>((yy * tilesX + xx) * 3 + kk)];
                        count += 3;
                    }
                size_t i = static_cast<size_t>((y * tilesX + x) * 3 + k);
                if (!counts(i)) continue;
                double var = around / count + 0.002 * r[i] * 0.002 * r[i] + 0.0005 * overall * 0.0005 * overall;
                double z = (c[i] - r[i]) / std::sqrt(var);
                v.worstZ = std::max(v.worstZ, std::abs(z));
                beyond4 += std::abs(z) > 4;
                sumDifference += (c[i] - r[i]) * (c[i] - r[i]);
                sumNoise += variance[i];
            }
    v.difference = std::sqrt(sumDifference / static_cast<double>(n)) / overall;
    v.noise = std::sqrt(sumNoise / static_cast<double>(n)) / overall;
    auto fail = [&](const std::string &why) {
        v.good = false;
        v.why += (v.why.empty() ? "" : "; ") + why;
    };
    for (int k = 0; k < 3; ++k) {
        double relative = (meanCandidate[k] - meanReference[k]) / magnitude[k];
        double error = std::sqrt(errorOfMean[k]) / magnitude[k];
        v.means[k] = relative;
        if (std::abs(relative) > std::abs(v.mean)) v.mean = relative;
        if (std::abs(relative) > (record.compare == "loose" ? 0.009 : 0.01))
            fail(fmt::format("mean of channel {} off by {:.2f} %", k, 100 * relative));
        else if (record.compare != "loose" && std::abs(relative) > std::max(4 * error, 0.003))
            fail(fmt::format("mean of channel {} off by {:.2f} % (noise {:.2f} %)", k, 100 * relative, 100 * error));
    }
    if (record.compare == "tiles") {
        // The tile noise is estimated from two runs each, so single tiles have heavy tails: 1 in 100 may pass 4 sigma.
        if (static_cast<double>(beyond4) > std::max(3.0, 0.01 * static_cast<double>(n)))
            fail(fmt::format("{} of {} tile means beyond 4 sigma", beyond4, n));
        if (v.worstZ > 12) fail(fmt::format("a tile at {:.1f} sigma", v.worstZ));
        if (v.difference > 2 * v.noise + 0.001) fail("tile differences exceed twice the noise");
    } else if (v.difference > 2 * v.noise + 0.02) {
        fail("tile differences exceed the noise");
    }
    return v;
}

Image ReadReference(const std::string &file) { return ReadImage(kSuite + file).image; }

/// Channels beyond R, G, B. Spectral buckets by the tile test, three at a time (the last ones twice if need be).
/// In a gbuffer the share of pixels whose means differ much more than those of the two references is limited, and
/// variances must agree within a factor.
std::string CompareFurtherChannels(const Record &record, const Image &a, const Image &b, const Image &c1,
                                   const Image &c2, int tile) {
    std::vector<std::string> buckets;
    std::string why;
    for (const std::string &name : a.Channels()) {
        if (name == "R" || name == "G" || name == "B") continue;
        if (c1.FindChannel(name) < 0) return "no channel " + name;
        if (name.starts_with("S0.")) {
            buckets.push_back(name);
            continue;
        }
        const int ia = a.FindChannel(name), ic = c1.FindChannel(name);
        double meanReference = 0, meanCandidate = 0, size = 0;
        int off = 0;
        const Point2i r = a.Resolution();
        for (int y = 0; y < r.y; ++y)
            for (int x = 0; x < r.x; ++x) {
                const double va = double(a.Get({x, y}, ia)), vb = double(b.Get({x, y}, ia));
                const double v1 = double(c1.Get({x, y}, ic)), v2 = double(c2.Get({x, y}, ic));
                const double mean = (va + vb) / 2, noise = std::abs(va - vb) + std::abs(v1 - v2);
                meanReference += mean;
                meanCandidate += (v1 + v2) / 2;
                size += std::abs(mean) / (r.x * r.y);
                off += std::abs((v1 + v2) / 2 - mean) > 3 * noise + 0.02 * std::abs(mean) + 0.005;
            }
        if (name.find("ariance") != std::string::npos) {
            if (meanCandidate < meanReference / 1.5 || meanCandidate > meanReference * 1.5)
                why += fmt::format("; {} is {:.2f} times the reference", name, meanCandidate / meanReference);
        } else if (off > r.x * r.y / 50) {
            why += fmt::format("; {} differs in {} of {} pixels", name, off, r.x * r.y);
        } else if (!name.starts_with("dz") &&  // a few pixels along silhouettes hold most of the mean of these
                   std::abs(meanCandidate - meanReference) > 0.02 * size * r.x * r.y) {
            why += fmt::format("; mean of {} differs by {:.2f} %", name,
                               100 * std::abs(meanCandidate - meanReference) / (size * r.x * r.y));
        }
    }
    for (size_t i = 0; i < buckets.size(); i += 3) {
        const size_t first = std::min(i, buckets.size() - std::min<size_t>(3, buckets.size()));
        const std::vector<std::string> names(
            buckets.begin() + static_cast<std::ptrdiff_t>(first),
            buckets.begin() + static_cast<std::ptrdiff_t>(std::min(first + 3, buckets.size())));
        if (names.size() < 3) break;
        auto means = [&](const Image &image) { return TileMeans(image.Select(names), tile); };
        Verdict v = Compare(record, means(a), means(b), means(c1), means(c2), (a.Resolution().x + tile - 1) / tile, {});
        if (!v.good) why += fmt::format("; {} to {}: {}", names.front(), names.back(), v.why);
    }
    return why.empty() ? "" : why.substr(2);
}

}  // namespace

int main(int argc, char **argv) {
    std::string group, only, write;
    double scale = 0.25;
    for (int i = 1; i < argc; i += 2) {
        const std::string flag = i + 1 < argc ? argv[i] : "";
        if (flag == "--group") group = argv[i + 1];
        else if (flag == "--name") only = argv[i + 1];
        else if (flag == "--scale") scale = std::atof(argv[i + 1]);
        else if (flag == "--write") write = argv[i + 1];
        else {
            fmt::print(stderr, "usage: conformance [--group g] [--name n] [--scale s] [--write folder]\n");
            return 2;
        }
    }
    ThreadLimit threads(0);
    nlohmann::json manifest = nlohmann::json::parse(std::ifstream(kSuite + "manifest.json"));
    const std::set<std::string> unsupported = ReadList("not_supported.txt");

    int passed = 0, failed = 0;
    fmt::print("{:<44} {:>10} {:>9} {:>9} {:>7}  {}\n", "scene", "difference", "noise", "mean", "worst z", "verdict");
    for (const auto &entry : manifest) {
        if (!entry.contains("reference")) continue;
        Record r{entry["name"],       entry["category"], entry["scene"], entry["reference"],
                 entry["referenceB"], entry["compare"],  entry["spp"]};
        if ((!group.empty() && r.category != group) || (!only.empty() && r.name != only)) continue;
        const std::string label = r.category + "/" + r.name;
        std::string verdict;
        bool good = false;
        try {
            RenderRequest request;
            request.file = kSuite + r.scene;
            // Scenes with a fixed sample count keep it; texture footprints stop shrinking at 64 samples, and the blur
            // of photons depends on the number of iterations.
            bool fixed = r.compare == "mean" || r.name == "imagemap_filters" || r.name == "sppm";
            // Of mlt the reference has most of the noise.
            const double share = r.name == "mlt" ? scale / 3 : scale;
            int spp = fixed ? r.spp : std::max(64, static_cast<int>(r.spp * share));
            request.build.samplesPerPixel = spp;
            request.build.seed = 100;
            Rendered one = RenderScene(request);
            request.build.seed = 101;
            Rendered two = RenderScene(request);
            if (unsupported.count(label)) {
                verdict = "FAIL: it renders, but not_supported.txt lists it";
            } else {
                if (!write.empty()) WriteImage(write + "/" + r.category + "_" + r.name + ".exr", one.image);
                Image a = ReadReference(r.referenceA), b = ReadReference(r.referenceB);
                if (a.Resolution() != one.image.Resolution()) {
                    verdict = fmt::format("FAIL: size {}x{}, reference {}x{}", one.image.Resolution().x,
                                          one.image.Resolution().y, a.Resolution().x, a.Resolution().y);
                } else {
                    int tile = r.compare == "mean" ? 16 : 8;
                    int tilesX = (a.Resolution().x + tile - 1) / tile;
                    Verdict v = Compare(r, TileMeans(a, tile), TileMeans(b, tile), TileMeans(one.image, tile),
                                        TileMeans(two.image, tile), tilesX, AmbiguousTiles(label, tile, tilesX));
                    if (a.ChannelCount() > 3)
                        if (std::string why = CompareFurtherChannels(r, a, b, one.image, two.image, tile);
                            !why.empty()) {
                            v.good = false;
                            v.why += (v.why.empty() ? "" : "; ") + why;
                        }
                    good = v.good;
                    if (std::vector<double> departure = Departure(label); !departure.empty()) {
                        good = true;
                        for (int k = 0; k < 3; ++k)
                            good &= std::abs(v.means[k] - departure[static_cast<size_t>(k)]) < 0.005;
                        if (!good)
                            v.why = fmt::format("departures.txt has other means: {:.2f}, {:.2f}, {:.2f} %",
                                                100 * v.means[0], 100 * v.means[1], 100 * v.means[2]);
                    }
                    fmt::print("{:<44} {:>9.3f}% {:>8.3f}% {:>8.3f}% {:>7.1f}  {}\n", label, 100 * v.difference,
                               100 * v.noise, 100 * v.mean, v.worstZ,
                               !good    ? "FAIL: " + v.why
                               : v.good ? "ok"
                                        : "ok (departs as in departures.txt)");
                }
            }
        } catch (const UserError &e) {
            // The whole message is printed only if it is unexpected.
            const std::string message = FormatAll(e);
            good = unsupported.count(label) && message.find("not supported yet") != std::string::npos;
            verdict = good ? "ok (an error: not supported)" : fmt::format("FAIL:\n{}", message);
        }
        if (!verdict.empty()) fmt::print("{:<44} {:>10} {:>9} {:>9} {:>7}  {}\n", label, "-", "-", "-", "-", verdict);
        std::fflush(stdout);
        ++(good ? passed : failed);
    }
    fmt::print("{} passed, {} failed\n", passed, failed);
    return failed == 0 && passed > 0 ? 0 : 1;
}
