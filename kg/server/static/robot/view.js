// The robot from above, where a simulation shows itself.

/** The last picture, also while the page had no place for it: each is sent once, maybe before the page has its robot. */
let newest = null;

/** Show the place for the picture in `host` while there is one. */
export function view(host, { view: there, state }) {
  host.hidden = !there || state !== "connected";
  if (host.hidden) host.replaceChildren();
  else if (newest && !host.firstElementChild) draw(host);
}

/** Show a picture as an image, in which no script runs; `clicked` receives the point, as shares of width and height. */
export function show(host, picture, clicked) {
  newest = { picture, clicked };
  if (!host.hidden) draw(host);
}

function draw(host) {
  let image = host.firstElementChild;
  if (!image) {
    image = document.createElement("img");
    image.alt = "The robot from above, in its simulated world";
    image.addEventListener("click", ({ offsetX, offsetY }) => newest.clicked(offsetX / image.clientWidth, offsetY / image.clientHeight));
    host.append(image);
  }
  image.src = `data:image/svg+xml,${encodeURIComponent(newest.picture)}`;
}
