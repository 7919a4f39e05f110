// SPDX-License-Identifier: LGPL-2.1-or-later
// Every numeric attribute of every component, taken from the attribute table, given what it should not get, and scenes
// that are damaged.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>

#include "attributes/stock.hpp"
#include "attributes/texts.hpp"
#include "attributes/words.hpp"
#include "body_state.hpp"
#include "hexaplast/base/error.hpp"
#include "hexaplast/body.hpp"
#include "support/example_scene.hpp"
#include "support/files.hpp"
#include "support/scene.hpp"

namespace {

using namespace hexaplast;
using namespace hexaplast::support;

using attributes::Access;
using attributes::Attribute;
using attributes::Description;
using attributes::Type;

int numbers_wanted(Type type) {
  static const std::map<Type, int> kWanted = {{Type::kInteger, 1}, {Type::kReal, 1},     {Type::kIntegers, 1},
                                              {Type::kReals, 1},   {Type::kVector3, 3},  {Type::kVectors3, 3},
                                              {Type::kBoxes, 6},   {Type::kHexahedra, 8}};
  const auto found = kWanted.find(type);
  return found == kWanted.end() ? 0 : found->second;
}

bool is_integer(Type type) { return type == Type::kInteger || type == Type::kIntegers || type == Type::kHexahedra; }
bool is_single(Type type) { return type == Type::kInteger || type == Type::kReal; }

std::string repeated(const std::string& word, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += word + " ";
  return text;
}

/// What the scene says to one value of one attribute.
struct Answer {
  std::string refusal_of_text;   ///< of the text by itself
  std::string refusal_of_scene;  ///< by init or by a step
};

/// The example scenes of all components that do something, and of Node, in a folder of their own: some write files.
class ExampleScenes : public testing::Test {
 protected:
  ExampleScenes() : folder_(fs::temp_directory_path() / ("scene_attributes_" + std::to_string(::getpid()))) {
    plugins();
    for (const Description* description : factory().descriptions())
      category_of_[std::string(description->class_name)] = description->category;
    fs::create_directories(folder_);
    fs::current_path(folder_);
  }
  ~ExampleScenes() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  std::string scene_with(const Description& component) {
    const auto example =
        std::ranges::find(attributes::examples(), component.class_name, &attributes::Example::class_name);
    const std::string lines = example == attributes::examples().end() ? "<" + std::string(component.class_name) + "/>"
                                                                      : std::string(example->lines);
    return support::pasted(std::string(attributes::example_scene()), lines, category_of_);
  }

  template <class Visit>
  void for_each_numeric_attribute(const Visit& visit) {
    std::vector<const Description*> all = factory().descriptions();
    all.push_back(&attributes::kNode);
    for (const Description* component : all) {
      for (const Attribute& attribute : component->attributes) {
        if (numbers_wanted(attribute.type) == 0 || attribute.access == Access::kOutput) continue;
        SCOPED_TRACE(std::string(component->class_name) + "." + std::string(attribute.name));
        visit(*component, attribute);
      }
    }
  }

  Answer answer_to(const Description& component, const Attribute& attribute, const std::string& value) {
    scene::Scene scene = read(scene_with(component));
    scene::Object* object = &scene.root();
    if (component.class_name != attributes::kNode.class_name) {
      for (scene::Component* each : scene.root().all<scene::Component>())
        if (each->class_name() == component.class_name) object = each;
    }
    EXPECT_EQ(object->class_name(), component.class_name);
    try {
      object->find_data(attribute.name)->read(value, {"test.scn", 1});
    } catch (const InputError& error) {
      return {error.what(), ""};
    }
    try {
      scene.init();
      for (int step = 0; step < 2; ++step) scene.step();
    } catch (const scene::SceneError& error) {
      EXPECT_TRUE(has(error.what(), "error: "));
      return {"", error.what()};
    } catch (const InputError& error) {
      return {"", error.what()};
    } catch (const NumericalError& error) {
      return {"", error.what()};
    }
    for (scene::MechanicalState* state : scene.root().all<scene::MechanicalState>()) {
      EXPECT_TRUE(state->positions().allFinite()) << value;
      EXPECT_TRUE(state->velocities().allFinite()) << value;
    }
    for (scene::ForceField* field : scene.root().all<scene::ForceField>())
      if (const Body* body = field->body()) {
        EXPECT_NO_THROW(validate(body->state().model, body->state().history)) << value;
      }
    return {};
  }

  std::map<std::string, std::string> category_of_;

 private:
  const fs::path before_ = fs::current_path(), folder_;
};

TEST_F(ExampleScenes, NumbersOutOfRangeAreRefusedWithTheRangeAndOthersRunOrAreRefused) {
  for_each_numeric_attribute([&](const Description& component, const Attribute& attribute) {
    const int count = numbers_wanted(attribute.type);
    if (!is_single(attribute.type)) answer_to(component, attribute, "");
    const std::vector<std::string> words = is_integer(attribute.type)
                                               ? std::vector<std::string>{"-1", "0", "1", "2147483646", "2147483648"}
                                               : std::vector<std::string>{"-1", "0", "1", "1e308", "1e-320"};
    for (const std::string& word : words) {
      const Answer answer = answer_to(component, attribute, repeated(word, count));
      if (attribute.range.contains(std::strtod(word.c_str(), nullptr))) continue;
      EXPECT_TRUE(has(answer.refusal_of_text, attributes::describe(attribute.range))) << word;
    }
  });
}

// Reading a scene, resetting it, and looking at it, for which the live window adds a grip to it: its state is the same.
TEST_F(ExampleScenes, BeginAlikeHoweverOften) {
  const fs::path meshes = HEXAPLAST_TEST_DATA "/meshes";
  for (const char* name : {"block.msh", "block.vtk", "organ.obj"}) fs::copy(meshes / name, name);
  fs::copy(meshes / "organ_binary.stl", "skin.stl");
  fs::copy(meshes / "surface.obj", "skin.obj");
  for (const Description* component : factory().descriptions()) {
    if (component->takes_anything || component->category == "Test") continue;
    SCOPED_TRACE(component->class_name);
    const std::string text = scene_with(*component);
    scene::Scene scene = read_and_init(text);
    const std::vector<std::byte> first = saved(scene);
    for (const int num_steps : {0, 0, 3}) {
      run(scene, num_steps);
      scene.reset();
      EXPECT_TRUE(saved(scene) == first) << "reset after " << num_steps << " steps";
    }
    scene::Scene again = read_and_init(text);
    EXPECT_TRUE(saved(again) == first) << "read again";

    for (const int num_steps : {0, 3}) {
      run(scene, num_steps);
      std::vector<PointArray> before;
      const std::vector<scene::MechanicalState*> states = scene.root().all<scene::MechanicalState>();
      for (scene::MechanicalState* state : states) before.push_back(state->positions());
      std::unique_ptr<scene::Component> grip = factory().make("GraspForceField");
      grip->find_data("keyTimes")->set(std::vector<double>{0}, {});
      grip->find_data("positions")->set(std::vector<double>{9, 9, 9}, {});
      grip->find_data("radius")->set(0.1, {});
      grip->find_data("graspTime")->set(1e9, {});
      scene.add(states.front()->node(), std::move(grip), "grip" + std::to_string(num_steps));
      for (std::size_t k = 0; k < states.size(); ++k)
        EXPECT_EQ(states[k]->positions(), before[k]) << "after " << num_steps << " steps";
    }
  }
}

TEST_F(ExampleScenes, WithoutAnyOneAttributeTheyRunOrAreRefused) {
  int num_left_out = 0, num_refused = 0;
  for (const Description* component : factory().descriptions()) {
    if (component->takes_anything) continue;
    const std::string whole = scene_with(*component);
    const std::regex attribute("\\s\\w+=\"[^\"]*\"");
    for (std::sregex_iterator match(whole.begin(), whole.end(), attribute), end; match != end; ++match) {
      std::string scene = whole;
      scene.erase(match->position(), match->length());
      const std::string errors = errors_of(scene);
      EXPECT_TRUE(errors.empty() || errors.find("test.scn:") == 0) << errors;
      ++num_left_out;
      num_refused += !errors.empty();
    }
  }
  EXPECT_GT(num_left_out, 200);
  EXPECT_GT(num_refused, 20);
}

TEST_F(ExampleScenes, NodesAndHexahedraThatDoNotExistAreRefused) {
  int num_lists = 0;
  for_each_numeric_attribute([&](const Description& component, const Attribute& attribute) {
    if (attribute.type != Type::kIntegers && attribute.type != Type::kHexahedra) return;
    if (attribute.access == Access::kIgnored) return;
    ++num_lists;
    const Answer answer = answer_to(component, attribute, repeated("2147483646", numbers_wanted(attribute.type)));
    EXPECT_NE(answer.refusal_of_text + answer.refusal_of_scene, "");
  });
  EXPECT_GE(num_lists, 4);
}

std::map<std::string, std::string> shipped_scenes() {
  std::map<std::string, std::string> scenes;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(HEXAPLAST_SOURCE_DIR) / "scenes")) {
    if (entry.path().extension() != ".scn") continue;
    scenes[entry.path().filename().string()] = content(entry.path());
  }
  return scenes;
}

// A damaged scene loads, or is refused by one of the three ways that the command reports; anything else ends the test.
void expect_clean(const std::string& text) {
  try {
    scene::Scene scene = read(text);
    scene.init();
  } catch (const scene::SceneError& error) {
    EXPECT_TRUE(has(error.what(), "test.scn"));
  } catch (const scene::PluginError& error) {
    EXPECT_TRUE(has(error.what(), "RequiredPlugin"));
  }
}

// How many mutations of each scene: enough for a build by default, as many as HEXAPLAST_MUTATIONS says for a long run,
// which takes every truncation too.
const char* const kMutations = std::getenv("HEXAPLAST_MUTATIONS");

// A scene is one element: whatever is cut off, its end is missing, which is said once and of a line that is there.
TEST(DamagedScene, TruncationsOfTheShippedScenesAreRefused) {
  for (const auto& [name, text] : shipped_scenes()) {
    const std::size_t end = text.rfind("</Node>") + 7;  // what may be missing behind it does not matter
    for (std::size_t length = 0; length < end; length += kMutations ? 1 : 3) {
      try {
        read(text.substr(0, length));
        ADD_FAILURE() << name << " is read though it is cut after " << length << " characters";
      } catch (const scene::SceneError& error) {
        const std::string said = error.what();
        int line = 0;
        EXPECT_EQ(std::sscanf(said.c_str(), "test.scn:%d: error: ", &line), 1) << said;
        EXPECT_TRUE(line >= 1 && line <= 1 + std::ranges::count(text.begin(), text.begin() + length, '\n')) << said;
        EXPECT_FALSE(has(said, "\n"));
      }
    }
  }
}

TEST(DamagedScene, MutationsOfTheShippedScenesAreRefusedOrLoad) {
  // half the changes put something that means something
  const std::string characters = "<>/\"'=&;@.-+0123456789eE \n\tnxX_!";

  const auto scenes = shipped_scenes();
  ASSERT_FALSE(scenes.empty());
  std::mt19937 random(20240607);
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  for (const auto& [name, whole] : scenes) {
    for (int i = 0; i < (kMutations ? std::atoi(kMutations) : 100); ++i) {
      std::string text = whole;
      for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
        const char value = below(2) ? characters[below(characters.size())] : static_cast<char>(below(256));
        const std::size_t at = below(text.size());
        switch (below(3)) {
          case 0:
            text[at] = value;
            break;
          case 1:
            text.insert(at, 1, value);
            break;
          default:
            text.erase(at, 1 + below(20));
        }
      }
      expect_clean(text);
    }
  }
}

}  // namespace
