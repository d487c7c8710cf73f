// Plays the frames that the file carries, with the skeleton and the salient trails over them.

const { frames, times, poses, bones, trails, size } = JSON.parse(
  document.getElementById("recording").textContent,
);
const canvas = document.querySelector("canvas");
const slider = document.querySelector("input");
const button = document.querySelector("button");
const clock = document.querySelector("output");
const context = canvas.getContext("2d");
const images = frames.map((source) => Object.assign(new Image(), { src: source }));
const REST = 600; // ms that the last frame stands before it starts over

[canvas.width, canvas.height] = size;
slider.max = String(frames.length - 1);

const styles = getComputedStyle(document.documentElement);
const colour = (name) => styles.getPropertyValue(name);

const at = (landmark) => landmark && [landmark[0] * canvas.width, landmark[1] * canvas.height];

function line(points, colour, width) {
  context.beginPath();
  let down = false;
  for (const point of points) {
    if (!point) down = false;
    else if (down) context.lineTo(...point);
    else {
      context.moveTo(...point);
      down = true;
    }
  }
  Object.assign(context, {
    strokeStyle: colour,
    lineWidth: width,
    lineCap: "round",
    lineJoin: "round",
  });
  context.stroke();
}

function draw(index) {
  context.drawImage(images[index], 0, 0, canvas.width, canvas.height);
  const pose = poses[index];
  for (const [from, to] of bones)
    if (pose[from] && pose[to]) line([at(pose[from]), at(pose[to])], colour("--picture-bone"), 2);
  for (const landmark of trails)
    line(
      poses.slice(0, index + 1).map((each) => at(each[landmark])),
      colour("--picture-accent"),
      4,
    );
  clock.textContent = `${times[index].toFixed(2)} s`;
  slider.value = String(index);
}

let started = 0; // when the first frame was due, while playing

function step(now) {
  if (!started) return;
  const elapsed = (now - started) / 1000 + times[0];
  if (elapsed > times.at(-1) + REST / 1000) started = now;
  const next = times.findIndex((time) => time > elapsed);
  draw(next < 0 ? times.length - 1 : Math.max(0, next - 1));
  requestAnimationFrame(step);
}

function play(on) {
  started = on
    ? performance.now() - 1000 * (times[Number(slider.value) % (frames.length - 1 || 1)] - times[0])
    : 0;
  button.textContent = on ? "Pause" : "Play";
  if (on) requestAnimationFrame(step);
}

button.onclick = () => play(!started);
slider.oninput = () => {
  play(false);
  draw(Number(slider.value));
};
Promise.all(images.map((image) => image.decode())).then(() => draw(0));
