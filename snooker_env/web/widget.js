/**
 * How does a notebook show a replay? Its host calls `render` with the widget's model and an element. This code follows `table.js`, whose
 * `mount` it uses. The model's traits: `data`, `options`, and `stroke`, `time`, `playing`, which are synchronised in both directions.
 */

function render({ model, el }) {
  el.dataset.lmSuppressShortcuts = "true"; // JupyterLab: keys pressed here are no commands of the notebook
  el.addEventListener("keydown", event => event.stopPropagation());
  const sent = {}; // the values last sent to the model
  let player = null;
  const report = () => {
    if (!player) return; // the player is being made
    const now = { playing: player.playing, stroke: player.stroke };
    if (!now.playing) now.time = player.time; // sixty messages a second would only keep the kernel busy
    const changed = Object.keys(now).filter(name => now[name] !== sent[name]);
    if (!changed.length) return;
    for (const name of changed) model.set(name, sent[name] = now[name]);
    model.save_changes();
  };
  player = mount(el, model.get("data"), { ...model.get("options"), autoplay: false, ontime: report });
  const asked = {
    "change:time": () => {
      if (model.get("time") === sent.time) return; // sent from here
      sent.time = model.get("time"); // so that a time beyond the end is corrected
      player.seek(model.get("stroke"), sent.time);
    },
    "change:stroke": () => {
      if (model.get("stroke") === sent.stroke) return;
      sent.stroke = model.get("stroke");
      player.seek(sent.stroke, model.get("time") === sent.time ? 0 : model.get("time"));
    },
    "change:playing": () => {
      if (model.get("playing") === sent.playing) return;
      sent.playing = model.get("playing");
      if (sent.playing) player.play(); else player.pause();
    },
  };
  for (const [name, act] of Object.entries(asked)) model.on(name, act);
  if (model.get("stroke") || model.get("time")) player.seek(model.get("stroke"), model.get("time"));
  if (model.get("playing")) player.play();
  report();
  return () => {
    for (const [name, act] of Object.entries(asked)) model.off(name, act);
    player.destroy();
  };
}

export default { render };
