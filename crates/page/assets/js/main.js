// ---- main.js: puts the page together.

/** Says in the hero why there is no moving hair. */
function sayNoScene(error) {
  const message = document.getElementById("scene-message");
  message.textContent = `No moving hair here: ${error.message}.`;
  message.hidden = false;
  document.getElementById("hero").classList.add("without-scene");
}

/** The hairstyles, unpacked as they are asked for. */
class Hair {
  constructor(data) {
    this.data = data;
    this.ready = data.map(() => null);
    this.current = null;
  }

  async load(index) {
    if (!this.ready[index]) {
      const data = this.data[index];
      const times = data.times_secs;
      const motion = new Motion(times, await unpackPositions(data.positions));
      const compared = data.compared ? new Motion(times, await unpackPositions(data.compared.positions)) : null;
      this.ready[index] = { data, motion, compared, counts: data.counts };
    }
    return this.ready[index];
  }
}

/** To which side the outside wind blows on the whole: +1 the subject's left, -1 the right. */
function leeward(outside) {
  const sum = outside.reduce((sum, v) => add(sum, v), [0, 0, 0]);
  return sum[1] < -0.2 * norm(sum) ? -1 : 1;
}

/** Buttons to choose a hairstyle; none are needed for one. */
function wireHairChoice(hair, show) {
  const place = document.getElementById("hair-choice");
  place.hidden = hair.data.length < 2;
  hair.data.forEach((data, index) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = data.name;
    button.addEventListener("click", () => show(index));
    place.append(button);
  });
}

async function start() {
  const { body, span_secs, start_secs } = page;
  const player = new Player(span_secs, start_secs, 1 / 60);
  const bust = new Bust(body.shapes);
  const turn = new Turn(body.turn, body.turn ? await unpack(body.turn.quaternions) : null, body.pivot_m);
  const hair = new Hair(page.hair);
  const views = [];

  let stage = null;
  try {
    if (page.hair.length === 0) throw new Error("the page was made without a hairstyle");
    const first = await hair.load(0);
    stage = new Stage(document.getElementById("scene"), body, bust, leeward(page.wind.outside));
    stage.headTurn = turn;
    stage.setHair(first.data, first.motion, first.compared);
    views.push(stage);
  } catch (error) {
    console.warn(error);
    sayNoScene(error);
  }

  const show = async (index) => {
    const chosen = await hair.load(index);
    hair.current = chosen;
    document.getElementById("hair-about").textContent = chosen.data.about;
    document.querySelectorAll("#hair-choice button").forEach((b, k) => b.setAttribute("aria-pressed", String(k === index)));
    if (!stage) return;
    stage.setHair(chosen.data, chosen.motion, chosen.compared);
    const button = stage.button("compared");
    button.hidden = !chosen.compared;
    if (chosen.compared) button.textContent = chosen.data.compared.name;
  };
  wireHairChoice(hair, show);
  if (page.hair.length > 0) await show(0);

  run(player, views);
  wireKeys(player, stage ?? { zoom() {}, toggle() {}, setView() {} });
  wirePlots(player);
  player.show();
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.toggle();

  // The rest may take a moment; the hair is moving by now.
  const markers = new Markers(page.markers, await unpackPositions(page.markers));
  if (stage) stage.markers = markers;
  const { visible } = page.markers;
  const timeline = new Timeline(page.markers, await unpack(visible.shares), await unpack(visible.head), player);
  views.push(timeline);

  const wind = new Wind(page.wind, await unpack(page.wind.vectors), await unpack(page.wind.flags));
  if (stage) stage.arrows = new Arrows(wind, bust);
  const slice = new Slice(wind, bust, { turn, hair: () => hair.current ?? {} });
  const placeSlice = (place) => {
    if (stage) Object.assign(stage, { slicePlace: place, dirty: true });
  };
  slice.onPlace = placeSlice;
  slice.setPlace(slice.place);
  views.push(slice);

  const drawProfile = () => player.drawProfile(wind.times, page.wind.profile);
  drawProfile();
  addEventListener("resize", drawProfile);
  theme.listeners.push(() => {
    stage?.recolor();
    slice.recolor();
    slice.bodyImage = null;
    timeline.dirty = true;
    drawProfile();
  });
  document.documentElement.dataset.ready = "yes";
}

/** Draws what is in sight, once a screen frame. */
function run(player, views) {
  let before = performance.now();
  const frame = (now) => {
    const wallSecs = Math.max((now - before) / 1000, 0);
    before = now;
    player.advance(wallSecs);
    for (const view of views) view.draw(player.time, wallSecs);
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

start().catch((error) => {
  console.error(error);
  sayNoScene(error);
});
