// SPDX-License-Identifier: LGPL-2.1-or-later
// The window module: GLFW for the window and the mouse, Dear ImGui for what is written and moved by hand, OpenGL for
// the body.
#define GLFW_INCLUDE_NONE
#include "view/window.hpp"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hexaplast/mesh/sections.hpp"
#include "output/axis.hpp"
#include "output/colour_map.hpp"
#include "output/png_file.hpp"
#include "view/painter.hpp"
#include "view/trace.hpp"

namespace hexaplast::view {
namespace {

constexpr float kLeftWidth = 330, kRightWidth = 340;  // [pixels] of the panels
constexpr float kPlotHeight = 104;                    // [pixels]
constexpr float kFontSize = 15;                       // [pixels]
constexpr double kFirstRoom = 2;                      // clicks of the wheel: tissue will be drawn out
constexpr double kBusy = 0.25;                        // [s] over which rates are counted

constexpr ImU32 kInk = IM_COL32(33, 33, 38, 255);
constexpr ImU32 kFaint = IM_COL32(112, 116, 122, 255);
constexpr ImU32 kSteel = IM_COL32(41, 92, 140, 255);
constexpr ImU32 kRust = IM_COL32(196, 84, 40, 255);
constexpr ImU32 kLeaf = IM_COL32(72, 128, 74, 255);
constexpr ImU32 kPaper = IM_COL32(255, 255, 255, 235);
constexpr ImU32 kRule = IM_COL32(205, 210, 216, 255);

/// A quantity that colours show.
struct Colouring {
  Quantity quantity;
  const char* name;
  const char* unit;
  bool begins_at_zero;
};
constexpr std::array kColourings{Colouring{Quantity::kPlasticStrain, "plastic strain", "-", true},
                                 Colouring{Quantity::kStressNorm, "stress norm", "Pa", true},
                                 Colouring{Quantity::kYieldStress, "yield stress", "Pa", false},
                                 Colouring{Quantity::kVolumeRatio, "volume ratio", "-", false},
                                 Colouring{Quantity::kSpeed, "speed", "m/s", true}};
constexpr std::array kGhosts{"none", "original", "without forces"};

/// The window, its OpenGL context, and Dear ImGui within it.
class Screen {
 public:
  /// on_key: hears of keys before Dear ImGui does.
  Screen(int width, int height, const std::string& title, GLFWkeyfun on_key) {
    glfwSetErrorCallback([](int, const char* what) { problem() = what; });
    if (!glfwInit()) throw output::OutputError("no window can be opened: " + problem());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SAMPLES, 4);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window_) {
      glfwTerminate();
      throw output::OutputError("no window can be opened: " + problem());
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);

    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // nothing is left behind
    dress();
    glfwSetKeyCallback(window_, on_key);
    ImGui_ImplGlfw_InitForOpenGL(window_, true);  // calls those that are there already
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Screen() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  GLFWwindow* window() const { return window_; }

 private:
  static std::string& problem() {
    static std::string text;
    return text;
  }

  static void dress() {
    const std::string font = HEXAPLAST_FONT_DIRECTORY "/DejaVuSans.ttf";
    if (std::filesystem::exists(font)) ImGui::GetIO().Fonts->AddFontFromFileTTF(font.c_str(), kFontSize);
    ImGui::StyleColorsLight();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.WindowBorderSize = 0;
    style.WindowPadding = {14, 12};
    style.FrameRounding = style.GrabRounding = 4;
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 7};
    const auto colour = [](ImU32 rgba) { return ImGui::ColorConvertU32ToFloat4(rgba); };
    style.Colors[ImGuiCol_Text] = colour(kInk);
    style.Colors[ImGuiCol_WindowBg] = ImVec4(0.968f, 0.972f, 0.98f, 1);
    style.Colors[ImGuiCol_FrameBg] = ImVec4(0.90f, 0.915f, 0.935f, 1);
    style.Colors[ImGuiCol_Button] = ImVec4(0.87f, 0.90f, 0.935f, 1);
    style.Colors[ImGuiCol_SliderGrab] = style.Colors[ImGuiCol_CheckMark] = colour(kSteel);
    style.Colors[ImGuiCol_SliderGrabActive] = colour(kRust);
    style.Colors[ImGuiCol_Header] = ImVec4(0.87f, 0.90f, 0.935f, 1);
  }

  GLFWwindow* window_ = nullptr;
};

void explain(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(24 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

ImVec2 text_size(const std::string& words) { return ImGui::CalcTextSize(words.c_str()); }

/// One curve of a plot.
struct Curve {
  const char* name;
  ImU32 colour;
  const Trace& trace;
};

/// Curves over the same time, under a line that names them with their latest values.
void plot(const char* title, const char* unit, std::initializer_list<Curve> curves, double begin, double end) {
  ImDrawList* draw = ImGui::GetWindowDrawList();
  ImGui::TextUnformatted(fmt::format("{} [{}]", title, unit).c_str());
  ImVec2 pen = ImGui::GetItemRectMin();
  pen.x += ImGui::GetContentRegionAvail().x;
  for (auto curve = std::rbegin(curves); curve != std::rend(curves); ++curve) {
    if (curve->trace.empty()) continue;
    const std::string words = fmt::format("{}{}{:.3g}", curve->name, *curve->name ? " " : "", curve->trace.latest());
    pen.x -= text_size(words).x;
    draw->AddText(pen, curve->colour, words.c_str());
    pen.x -= 12;
  }

  const ImVec2 corner = ImGui::GetCursorScreenPos(), size{ImGui::GetContentRegionAvail().x, kPlotHeight};
  const ImVec2 opposite{corner.x + size.x, corner.y + size.y};
  ImGui::Dummy(size);
  draw->AddRectFilled(corner, opposite, IM_COL32_WHITE, 4);

  double least = 0, most = 0;
  for (const Curve& curve : curves) curve.trace.extend_range(begin, least, most);
  if (!(most > least)) most = least + 1e-12;
  const double room = 0.08 * (most - least);
  const auto place = [&](double time, double value) {
    return ImVec2(corner.x + size.x * static_cast<float>((time - begin) / (end - begin)),
                  opposite.y - size.y * static_cast<float>((value - least + room) / (most - least + 2 * room)));
  };
  const output::Ticks ticks = output::ticks_within(least, most, 3);
  for (const double value : ticks.values) {
    const float y = place(begin, value).y;
    draw->AddLine({corner.x, y}, {opposite.x, y}, kRule);
    draw->AddText(nullptr, 12, {corner.x + 4, std::max(y - 13, corner.y)}, kFaint, ticks.label(value).c_str());
  }
  draw->PushClipRect(corner, opposite, true);
  for (const Curve& curve : curves) {
    std::vector<ImVec2> line;
    curve.trace.for_each_since(begin, [&](double time, double value) { line.push_back(place(time, value)); });
    draw->AddPolyline(line.data(), static_cast<int>(line.size()), curve.colour, 0, 1.8f);
  }
  draw->PopClipRect();
  draw->AddRect(corner, opposite, kRule, 4);
}

/// Counts events per second.
class Rate {
 public:
  void count(long events, double now) {
    events_ += events;
    if (now - begin_ < kBusy) return;
    per_second_ = static_cast<double>(events_) / (now - begin_);
    events_ = 0;
    begin_ = now;
  }
  double per_second() const { return per_second_; }

 private:
  long events_ = 0;
  double begin_ = 0, per_second_ = 0;
};

/// Where the viewer stands at first: as in the pictures of a run.
Camera first_camera(const HexMesh& mesh, const output::Staging& staging) {
  const int long_axis = end_sections(mesh).axis;
  if (staging.viewpoint) {
    const Vec3& towards = staging.viewpoint->towards;
    const bool from_above = Vec3::UnitY().cross(towards.normalized()).norm() < 0.05;
    const Vec3 up = staging.viewpoint->up.value_or(from_above ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitY()));
    return {up, towards};
  }
  const Vec3 upright = Vec3::Unit(long_axis == 1 ? 2 : 1), along = Vec3::Unit(long_axis);
  return {upright, along.cross(upright) + 0.45 * along + 0.42 * upright};
}

class Window {
 public:
  explicit Window(WindowCall& call)
      : options_(call.options),
        is_asked_to_end_(call.is_asked_to_end),
        session_(call.subject, std::move(call.hand)),
        figure_(session_.mesh(), call.staging),
        camera_(first_camera(session_.mesh(), call.staging)),
        screen_(options_.width, options_.height, "Hexaplast – " + session_.title(), &Window::on_key),
        hand_(session_.suggested_hand()),
        pace_(options_.pace) {
    look_.shows_edges = call.staging.shows_hexahedra || !figure_.has_skins();
    look_.shows_skins = figure_.has_skins();
    glfwSetWindowUserPointer(screen_.window(), this);

    session_.set_pace(pace_);
    if (options_.steps)
      session_.advance(*options_.steps);
    else if (options_.is_running)
      session_.run();
  }

  /// Until it is closed. Returns the failure that the session ended in; empty: none.
  std::string show() {
    while (!session_.take(now_)) glfwWaitEventsTimeout(0.01);
    figure_.update(now_, look_);
    while (!glfwWindowShouldClose(screen_.window()) && !is_asked_to_end_()) {
      glfwPollEvents();
      look_at_session();
      draw_frame();
      if (wants_picture_) write_picture(next_picture());
      wants_picture_ = false;
      if (is_over()) {
        // the panels take a second frame to find their sizes
        draw_frame();
        if (options_.picture) write_picture(*options_.picture);
        break;
      }
      glfwSwapBuffers(screen_.window());
    }
    session_.release();
    session_.pause();
    session_.stop();
    return session_.failure();
  }

 private:
  bool is_over() const {
    return options_.steps && !now_.is_running && (now_.step >= *options_.steps || !now_.failure.empty());
  }

  static void on_key(GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS || ImGui::GetIO().WantTextInput) return;
    static_cast<Window*>(glfwGetWindowUserPointer(window))->press(key);
  }

  void press(int key) {
    switch (key) {
      case GLFW_KEY_SPACE:
        return toggle_running();
      case GLFW_KEY_S:
        return session_.advance(1);
      case GLFW_KEY_R:
        return reset();
      case GLFW_KEY_F:
        return fit();
      case GLFW_KEY_P:
        wants_picture_ = true;
        return;
      case GLFW_KEY_W:
        look_.shows_edges = !look_.shows_edges;
        return;
      case GLFW_KEY_G:
        look_.ghost = look_.ghost == Ghost::kNone ? Ghost::kOriginal : Ghost::kNone;
        return;
      case GLFW_KEY_Q:
        glfwSetWindowShouldClose(screen_.window(), GLFW_TRUE);
        return;
      default:
        return;
    }
  }

  void toggle_running() {
    if (now_.is_running)
      session_.pause();
    else
      session_.run();
  }

  void reset() {
    session_.reset();
    traces_ = {};
    greatest_.setEmpty();
  }

  void fit() { camera_.fit(figure_.box()); }

  void look_at_session() {
    const double clock = glfwGetTime();
    frames_.count(1, clock);
    long num_steps = 0;
    if (session_.take(now_)) {
      num_steps = static_cast<long>(now_.step_ms.size());
      traces_.add(now_);
      for (const std::string& message : now_.messages) message_ = message;
      if (shown_quantity_ != now_.quantity) greatest_.setEmpty();
      shown_quantity_ = now_.quantity;
    }
    steps_.count(num_steps, clock);
    figure_.update(now_, look_);
    greatest_.extend(figure_.range());
  }

  // ------------------------------------------------------------------------------------------------------- the frame

  void draw_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    left_ = kLeftWidth;
    width_ = std::max(size.x - kLeftWidth - kRightWidth, 50.0f);
    height_ = std::max(size.y, 50.0f);
    camera_.resize(static_cast<int>(width_), static_cast<int>(height_));
    if (!is_fitted_) {
      fit();
      camera_.zoom(-kFirstRoom);
    }
    is_fitted_ = true;

    panel("controls", 0, kLeftWidth, height_, [this] { draw_controls(); });
    panel("plots", size.x - kRightWidth, kRightWidth, height_, [this] { draw_plots(); });
    follow_mouse();
    draw_overlay();
    ImGui::Render();

    int pixels_across = 0, pixels_down = 0;
    glfwGetFramebufferSize(screen_.window(), &pixels_across, &pixels_down);
    const float density = size.x > 0 ? static_cast<float>(pixels_across) / size.x : 1;
    const auto [least, most] = scale();
    painter_.draw(figure_, camera_,
                  {static_cast<int>(left_ * density), 0, static_cast<int>(width_ * density), pixels_down}, least, most);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }

  template <class Draw>
  static void panel(const char* name, float left, float width, float height, const Draw& draw) {
    ImGui::SetNextWindowPos({left, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav);
    draw();
    ImGui::End();
  }

  /// Values at the ends of the colour bar: of all that was shown since the beginning.
  std::pair<double, double> scale() const {
    if (greatest_.isEmpty()) return {0, 0};
    return {colouring().begins_at_zero ? 0 : greatest_.min()[0], greatest_.max()[0]};
  }

  const Colouring& colouring() const { return kColourings[static_cast<std::size_t>(now_.quantity)]; }

  // ------------------------------------------------------------------------------------------------------ left panel

  void draw_controls() {
    ImGui::TextUnformatted(session_.title().c_str());
    ImGui::TextDisabled("step %ld   t = %.3f s", now_.step, now_.sample.time);

    const float across = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
    const ImVec2 third{(across - 2 * gap) / 3, 30};
    if (ImGui::Button(now_.is_running ? "pause" : "run", third)) toggle_running();
    explain("Space");
    ImGui::SameLine();
    if (ImGui::Button("step", third)) session_.advance(1);
    explain("S: one time step");
    ImGui::SameLine();
    if (ImGui::Button("reset", third)) reset();
    explain("R: back to the beginning, with the material as it is now");

    bool is_real_time = pace_ == Pace::kRealTime;
    if (ImGui::Checkbox("real time", &is_real_time))
      session_.set_pace(pace_ = is_real_time ? Pace::kRealTime : Pace::kFree);
    explain("As the clock on the wall, where steps are fast enough. Otherwise as fast as it goes.");
    ImGui::SameLine();
    if (ImGui::Button("picture")) wants_picture_ = true;
    explain("P: writes a PNG file of this window");
    ImGui::SameLine();
    if (ImGui::Button("fit")) fit();
    explain("F: looks at the whole body");

    heading("view");
    int chosen = static_cast<int>(now_.quantity);
    if (ImGui::BeginCombo("colour", colouring().name)) {
      for (int k = 0; k < static_cast<int>(kColourings.size()); ++k)
        if (ImGui::Selectable(kColourings[k].name, k == chosen)) session_.show(kColourings[k].quantity);
      ImGui::EndCombo();
    }
    int ghost = static_cast<int>(look_.ghost);
    if (ImGui::Combo("ghost", &ghost, kGhosts.data(), static_cast<int>(kGhosts.size())))
      look_.ghost = static_cast<Ghost>(ghost);
    explain("The shape behind the body: the original one, or the one that it would have without forces (G)");
    ImGui::Checkbox(figure_.has_skins() ? "cage" : "edges", &look_.shows_edges);
    explain("W: edges of the hexahedra");
    if (figure_.has_skins()) {
      ImGui::SameLine();
      ImGui::Checkbox("embedded surfaces", &look_.shows_skins);
    }

    heading("material");
    for (std::size_t k = 0; k < session_.knobs().size(); ++k) draw_knob(session_.knobs()[k], now_.knob_values[k]);

    heading("hand");
    ImGui::PushItemWidth(across * 0.5f);
    const HandSettings& usual = session_.suggested_hand();
    draw_slider("radius", "m", hand_.radius, usual.radius / 5, usual.radius * 10,
                "The hand holds the nodes of the surface that are as near to where it grips.");
    draw_slider("stiffness", "N/m", hand_.stiffness, usual.stiffness / 100, usual.stiffness * 100,
                "Of the spring between the mouse and what is held");
    draw_slider("greatest force", "N", hand_.most_force, usual.most_force / 100, usual.most_force * 100,
                "However far the mouse goes, the hand pulls no harder.");
    ImGui::PopItemWidth();

    if (!now_.failure.empty()) tell(kRust, now_.failure + "\nReset leads back to the beginning.");
    if (!message_.empty()) tell(kFaint, message_);
  }

  static void heading(const char* words) {
    ImGui::Dummy({0, 4});
    ImGui::TextDisabled("%s", words);
    ImGui::Separator();
  }

  static void tell(ImU32 colour, const std::string& words) {
    ImGui::Dummy({0, 4});
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(words.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
  }

  static bool draw_slider(const char* name, const char* unit, double& value, double least, double most,
                          const std::string& help) {
    const bool has_moved =
        ImGui::SliderScalar(name, ImGuiDataType_Double, &value, &least, &most, fmt::format("%.4g {}", unit).c_str(),
                            ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoRoundToFormat);
    explain(help);
    return has_moved;
  }

  void draw_knob(const Knob& knob, std::optional<double> value) {
    const std::string name(knob.attribute->name), unit(knob.attribute->unit);
    const std::string help = fmt::format("{}\n{}{}", knob.attribute->help, unit.empty() ? "" : "[" + unit + "]  ",
                                         scene::describe(knob.attribute->range));
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
    if (knob.num_values > 1) {
      ImGui::TextDisabled("%s: of each hexahedron", name.c_str());
      explain(help);
    } else if (!value) {
      bool is_given = false;
      if (ImGui::Checkbox(name.c_str(), &is_given)) session_.set(name, knob.suggested);
      explain(help);
    } else {
      const ImGuiSliderFlags flags =
          ImGuiSliderFlags_NoRoundToFormat | (knob.is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
      if (ImGui::SliderScalar(name.c_str(), ImGuiDataType_Double, &*value, &knob.least, &knob.most,
                              fmt::format("%.4g {}", unit).c_str(), flags))
        session_.set(name, *value);
      explain(help);
    }
    ImGui::PopItemWidth();
  }

  // ----------------------------------------------------------------------------------------------------- right panel

  void draw_plots() {
    const double end = std::max(now_.sample.time, traces_.kSpan), begin = end - traces_.kSpan;
    plot("elongation", "%",
         {{"world", kSteel, traces_.world_elongation}, {"plastic", kRust, traces_.plastic_elongation}}, begin, end);
    plot("greatest plastic strain", "-", {{"", kRust, traces_.plastic_strain}}, begin, end);
    plot("volume error", "%", {{"world", kSteel, traces_.world_volume}, {"plastic", kRust, traces_.material_volume}},
         begin, end);
    plot("energy", "J",
         {{"kin", kLeaf, traces_.kinetic}, {"el", kSteel, traces_.elastic}, {"diss", kRust, traces_.dissipated}}, begin,
         end);
    if (!traces_.step_ms.empty()) {
      const double last = traces_.step_ms.latest_time();
      plot("time of a step", "ms", {{"", kInk, traces_.step_ms}}, last - traces_.kSteps, last);
    }
    ImGui::TextDisabled("median %.3g ms   99th percentile %.3g ms", traces_.step_ms.quantile(0.5),
                        traces_.step_ms.quantile(0.99));
    ImGui::TextDisabled("a step lasts %.4g ms of simulated time", 1e3 * session_.dt());
  }

  // --------------------------------------------------------------------------------------------------------- overlay

  void draw_overlay() {
    ImDrawList* draw = ImGui::GetBackgroundDrawList();
    const std::string rates = fmt::format("{:.0f} frames/s   {:.0f} steps/s   {} hexahedra", frames_.per_second(),
                                          steps_.per_second(), session_.mesh().num_elements());
    draw->AddText({left_ + width_ - text_size(rates).x - 16, 14}, kFaint, rates.c_str());
    const char* help = "drag tissue: left   turn: right   move: middle   nearer: wheel";
    draw->AddText({left_ + 16, 14}, kFaint, help);
    if (grabbed_) draw_hand(draw);
    draw_colour_bar(draw);
  }

  /// The spring from what is held to the mouse.
  void draw_hand(ImDrawList* draw) {
    Vec3 held = Vec3::Zero();
    if (now_.held.empty()) return;
    for (const int node : now_.held)
      held += now_.positions.row(node).transpose() / static_cast<double>(now_.held.size());
    const Eigen::Vector2d pixel = camera_.pixel_of(held);
    const ImVec2 from{left_ + static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
        to = ImGui::GetIO().MousePos;
    draw->AddLine(from, to, kPaper, 5);
    draw->AddLine(from, to, kSteel, 2.2f);
    draw->AddCircle(from, 9, kPaper, 0, 5);
    draw->AddCircle(from, 9, kSteel, 0, 2.4f);
    draw->AddCircleFilled(to, 4, kSteel);
    const std::string force = fmt::format("{:.3g} N", now_.grip_force.norm());
    draw->AddText({to.x + 12, to.y - 8}, kSteel, force.c_str());
  }

  void draw_colour_bar(ImDrawList* draw) {
    const float bar = std::min(380.0f, width_ - 80), left = left_ + (width_ - bar) / 2, top = height_ - 54;
    const auto [least, most] = scale();
    const std::string words = greatest_.isEmpty() ? fmt::format("{}: it never yields", colouring().name)
                              : most > least
                                  ? fmt::format("{} [{}]", colouring().name, colouring().unit)
                                  : fmt::format("{} [{}]: {:.4g} everywhere", colouring().name, colouring().unit, most);
    draw->AddText({left_ + (width_ - text_size(words).x) / 2, top - 22}, kInk, words.c_str());
    if (!(most > least)) return;
    for (int k = 0; k < static_cast<int>(bar); ++k) {
      const output::Colour colour = output::colour_of((k + 0.5) / bar);
      const float x = left + static_cast<float>(k);
      draw->AddRectFilled({x, top}, {x + 1, top + 13},
                          ImGui::ColorConvertFloat4ToU32({colour.red, colour.green, colour.blue, 1}));
    }
    const output::Ticks ticks = output::ticks_within(least, most, 5);
    for (const double value : ticks.values) {
      const float x = left + bar * static_cast<float>((value - least) / (most - least));
      draw->AddLine({x, top + 13}, {x, top + 18}, kInk);
      const std::string label = ticks.label(value);
      draw->AddText({x - text_size(label).x / 2, top + 20}, kInk, label.c_str());
    }
  }

  // ----------------------------------------------------------------------------------------------------------- mouse

  void follow_mouse() {
    const ImGuiIO& io = ImGui::GetIO();
    const double x = io.MousePos.x - left_, y = io.MousePos.y;
    const bool is_inside = !io.WantCaptureMouse && x >= 0 && x < width_;
    if (is_inside && io.MouseWheel != 0) camera_.zoom(io.MouseWheel);
    if (is_inside && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !io.KeyShift) grab(x, y);
    for (const int button : {ImGuiMouseButton_Left, ImGuiMouseButton_Right, ImGuiMouseButton_Middle})
      if (is_inside && ImGui::IsMouseClicked(button)) turning_ = button;

    if (grabbed_ && io.MouseDown[ImGuiMouseButton_Left]) {
      session_.drag(camera_.at_depth_of(*grabbed_, x, y));
    } else if (grabbed_) {
      session_.release();
      grabbed_.reset();
    } else if (turning_ >= 0 && io.MouseDown[turning_]) {
      const bool is_panning = turning_ == ImGuiMouseButton_Middle || io.KeyShift;
      if (is_panning)
        camera_.pan(io.MouseDelta.x, io.MouseDelta.y);
      else
        camera_.orbit(io.MouseDelta.x, io.MouseDelta.y);
    } else {
      turning_ = -1;
    }
  }

  void grab(double x, double y) {
    const std::optional<Hit> hit = figure_.hit(camera_.ray(x, y));
    if (!hit) return;
    grabbed_ = hit->place;
    session_.grab(hit->place, hand_);
  }

  // --------------------------------------------------------------------------------------------------------- pictures

  std::filesystem::path next_picture() const {
    for (int number = 1;; ++number) {
      const auto file = options_.picture_folder / fmt::format("{}_{:03}.png", session_.title(), number);
      if (!std::filesystem::exists(file)) return file;
    }
  }

  void write_picture(const std::filesystem::path& file) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(screen_.window(), &width, &height);
    output::write_png(file, Painter::picture(width, height));
    message_ = file.string() + " written";
  }

  WindowOptions options_;
  std::function<bool()> is_asked_to_end_;
  Session session_;
  Snapshot now_;
  Figure figure_;
  Camera camera_;
  Screen screen_;
  Painter painter_;

  Look look_;
  HandSettings hand_;
  Pace pace_;
  Traces traces_;
  Rate frames_, steps_;
  Quantity shown_quantity_ = Quantity::kPlasticStrain;
  Eigen::AlignedBox1d greatest_;  // values shown since the beginning
  std::string message_;
  bool wants_picture_ = false, is_fitted_ = false;
  float left_ = 0, width_ = 1, height_ = 1;  // [pixels] of the part of the window that shows the body
  std::optional<Vec3> grabbed_;              // [m] where the tissue was taken hold of
  int turning_ = -1;                         // button of the mouse that moves the camera; -1: none
};

}  // namespace
}  // namespace hexaplast::view

/// Opens the window and returns when it is closed. The name, set by the build, carries the version of WindowCall.
extern "C" __attribute__((visibility("default"))) void HEXAPLAST_WINDOW_ENTRY(hexaplast::view::WindowCall& call) {
  call.failure = hexaplast::view::Window(call).show();
}
