#include "fuzz/case_maker.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace pbrt::fuzz {

namespace {

constexpr const char *kState = "state";

std::vector<std::string> TextsOf(const Corpus &corpus) {
    std::vector<std::string> texts;
    for (const SeedScene &s : corpus.scenes) texts.push_back(s.text);
    return texts;
}

std::string Join(const std::vector<std::string> &pieces) { return fmt::format("{}", fmt::join(pieces, "")); }

std::vector<std::string> Lines(const std::string &text) {
    std::vector<std::string> lines;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
        lines.push_back(text.substr(at, end - at));
        at = end;
    }
    return lines;
}

/// Words with the white space behind them.
std::vector<std::string> Words(const std::string &text) {
    std::vector<std::string> words;
    bool inSpace = true;
    for (char c : text) {
        const bool space = std::isspace(static_cast<unsigned char>(c)) != 0;
        if (words.empty() || (inSpace && !space)) words.emplace_back();
        words.back() += c;
        inSpace = space;
    }
    return words;
}

std::vector<std::string> Chunks(const std::string &bytes) {
    const size_t size = std::max<size_t>(1, bytes.size() / 64);
    std::vector<std::string> chunks;
    for (size_t at = 0; at < bytes.size(); at += size) chunks.push_back(bytes.substr(at, size));
    return chunks;
}

/// Leaves out runs of consecutive pieces, first half of all, then ever shorter runs, as long as `isGood` holds for the
/// rest.
std::vector<std::string> LeaveOut(std::vector<std::string> pieces,
                                  const std::function<bool(const std::vector<std::string> &)> &isGood) {
    for (size_t run = std::max<size_t>(1, pieces.size() / 2);; run /= 2) {
        for (size_t at = 0; at < pieces.size();) {
            std::vector<std::string> fewer(pieces.begin(), pieces.begin() + at);
            const size_t end = std::min(at + run, pieces.size());
            fewer.insert(fewer.end(), pieces.begin() + end, pieces.end());
            if (isGood(fewer)) pieces = std::move(fewer);
            else at += run;
        }
        if (run <= 1) return pieces;
    }
}

}  // namespace

CaseMaker::CaseMaker(Corpus corpus) : corpus_(std::move(corpus)), words_(TextsOf(corpus_)), kinds_(SceneKinds()) {
    for (const SeedScene &scene : corpus_.scenes) {
        if (!scene.isRendered) continue;
        rendered_.push_back(&scene);
        for (const std::string &name : scene.assets) {
            const CaseFile *asset = corpus_.Asset(name);
            uses_[AssetKind(*asset)].push_back({&scene, asset});
        }
    }
    for (const auto &[kind, uses] : uses_) kinds_.push_back(kind);
    kinds_.push_back(kState);
    std::sort(kinds_.begin(), kinds_.end());
}

FuzzCase CaseMaker::Unchanged(const SeedScene &scene) const {
    return {"none", scene.name, {{"scene.pbrt", scene.text}}, {"--nthreads=1", "--spp=1"}};
}

void CaseMaker::AddArguments(FuzzCase &made, Dice &dice) const {
    std::vector<std::string> &a = made.arguments;
    a = {"--nthreads=1"};
    // A mutated film may be as large as it likes if little of it is rendered.
    if (!dice.OneIn(12)) a.push_back("--pixelbounds=2,8,1,6");
    if (!dice.OneIn(12)) a.push_back("--spp=1");
    if (!dice.OneIn(12)) a.push_back("--maxdepth=3");
    static const std::vector<std::string> kRare = WordsOf(
        "--lightsampler=uniform --lightsampler=power --lightsampler=bvh --lightsampler=exhaustive "
        "--lightsampler=octree --lightsampler=octree:model=paper --lightsampler=spatial:voxels=2,samples=2 "
        "--lightsampler=neepp:voxels=2,samples=2 --lightsampler=oracle:samples=1 "
        "--mesh-lights --integrator=path --integrator=volpath "
        "--integrator=simplepath --integrator=ambientocclusion --integrator=randomwalk --force-diffuse "
        "--render-coord-sys=world --render-coord-sys=camera --texture-cache-mb=1 --write-partial-images "
        "--disable-pixel-jitter --disable-wavelength-jitter --disable-texture-filtering --quick --stats "
        "--seed=7 --displacement-edge-scale=.5 --cropwindow=.2,.7,.3,.8");
    if (dice.OneIn(3)) a.push_back(dice.Pick(kRare));
    if (a.back().starts_with("--cropwindow")) std::erase(a, "--pixelbounds=2,8,1,6");  // they exclude each other
    const std::string depthless = "ambientocclusion";                                  // takes no --maxdepth
    if (a.back().ends_with(depthless) || made.files.front().bytes.find(depthless) != std::string::npos)
        std::erase(a, "--maxdepth=3");
    const size_t format = dice.Below(6);
    made.output = format == 0 ? "out.png" : format == 1 ? "out.pfm" : "out.exr";
}

FuzzCase CaseMaker::Make(uint64_t seed, uint64_t number, const std::vector<std::string> &kinds) const {
    Dice dice(Dice(seed).Next() + number * 0xd1342543de82ef95ull);
    // Lenses take ten times as long as everything else.
    std::string kind = dice.Pick(kinds);
    if (kind == "lens" && !dice.OneIn(4)) kind = dice.Pick(kinds);
    if (kind == kState) return MakeStateCase(dice.Pick(corpus_.states), dice);
    size_t changes = 1;
    while (changes < 6 && dice.OneIn(3)) ++changes;

    FuzzCase made;
    made.kind = kind;
    if (auto it = uses_.find(kind); it != uses_.end()) {
        const Use &use = dice.Pick(it->second);
        made.seed = use.scene->name;
        CaseFile asset = *use.asset;
        for (size_t i = 0; i < changes; ++i) MutateAsset(asset, dice);
        std::string text = use.scene->text;
        const std::string shared = "\"../assets/" + asset.name + '"';
        asset.name = "mutated" + asset.name.substr(asset.name.find('.', asset.name.rfind('/') + 1));
        const std::string own = '"' + asset.name + '"';
        for (size_t at = text.find(shared); at != std::string::npos; at = text.find(shared, at))
            text.replace(at, shared.size(), own);
        made.files = {{"scene.pbrt", text}, asset};
    } else {
        const SeedScene &scene = *dice.Pick(rendered_);
        made.seed = scene.name;
        std::string text = scene.text;
        for (size_t i = 0; i < changes; ++i) MutateScene(text, kind, words_, dice);
        made.files = {{"scene.pbrt", text}};
    }
    AddArguments(made, dice);
    return made;
}

FuzzCase Shrink(FuzzCase failing, const std::function<bool(const FuzzCase &)> &stillFails, int maxTries) {
    int tries = 0;
    auto fails = [&](const FuzzCase &candidate) { return tries < maxTries && (++tries, stillFails(candidate)); };
    failing.arguments = LeaveOut(failing.arguments, [&](const std::vector<std::string> &arguments) {
        FuzzCase candidate = failing;
        candidate.arguments = arguments;
        return fails(candidate);
    });
    for (size_t i = 0; i < failing.files.size(); ++i) {
        const std::string original = failing.files[i].bytes;
        const bool isText = original.find('\0') == std::string::npos;
        auto split = [&](std::vector<std::string> (*into)(const std::string &)) {
            FuzzCase candidate = failing;
            failing.files[i].bytes =
                Join(LeaveOut(into(failing.files[i].bytes), [&](const std::vector<std::string> &pieces) {
                    candidate.files[i].bytes = Join(pieces);
                    return fails(candidate);
                }));
        };
        if (isText) {
            split(Lines);
            split(Words);
        } else {
            split(Chunks);
        }
    }
    return failing;
}

}  // namespace pbrt::fuzz
