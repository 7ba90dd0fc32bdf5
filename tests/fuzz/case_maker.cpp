#include "fuzz/case_maker.h"

#include <algorithm>

#include "fuzz/asset_mutators.h"
#include "fuzz/byte_mutators.h"

namespace pbrt::fuzz {

namespace {

constexpr const char *kState = "state";

std::vector<std::string> TextsOf(const Corpus &corpus) {
    std::vector<std::string> texts;
    for (const SeedScene &s : corpus.scenes) texts.push_back(s.text);
    return texts;
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

}  // namespace pbrt::fuzz
