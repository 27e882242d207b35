/**
 * How does a notebook show a replay? Its host calls `render` with the widget's model and an element; this follows `table.js`, whose `mount`
 * it uses. The model's traits: `data`, `options`, and `stroke`, `time`, `playing`, which go both ways.
 */

function render({ model, el }) {
  el.dataset.lmSuppressShortcuts = "true"; // JupyterLab: keys here are not the notebook's commands
  el.addEventListener("keydown", event => event.stopPropagation());
  const told = {}; // what the model was told last
  let player = null;
  const tell = () => {
    if (!player) return; // it is being made
    const now = { playing: player.playing, stroke: player.stroke };
    if (!now.playing) now.time = player.time; // sixty messages a second would only keep the kernel busy
    const changed = Object.keys(now).filter(name => now[name] !== told[name]);
    if (!changed.length) return;
    for (const name of changed) model.set(name, told[name] = now[name]);
    model.save_changes();
  };
  player = mount(el, model.get("data"), { ...model.get("options"), autoplay: false, ontime: tell });
  const asked = {
    "change:time": () => {
      if (model.get("time") === told.time) return; // it comes from here
      told.time = model.get("time"); // so that a time beyond the end is put right
      player.seek(model.get("stroke"), told.time);
    },
    "change:stroke": () => {
      if (model.get("stroke") === told.stroke) return;
      told.stroke = model.get("stroke");
      player.seek(told.stroke, model.get("time") === told.time ? 0 : model.get("time"));
    },
    "change:playing": () => {
      if (model.get("playing") === told.playing) return;
      told.playing = model.get("playing");
      if (told.playing) player.play(); else player.pause();
    },
  };
  for (const [name, act] of Object.entries(asked)) model.on(name, act);
  if (model.get("stroke") || model.get("time")) player.seek(model.get("stroke"), model.get("time"));
  if (model.get("playing")) player.play();
  tell();
  return () => {
    for (const [name, act] of Object.entries(asked)) model.off(name, act);
    player.destroy();
  };
}

export default { render };
