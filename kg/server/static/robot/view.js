// The robot from above, where a simulation shows itself.

/** What was shown last, also while there was no place for it: a picture is told once, maybe before the page knows of its robot. */
let newest = null;

/** Show the place for the picture in `host` while there is one. */
export function view(host, { view: there, state }) {
  host.hidden = !there || state !== "connected";
  if (host.hidden) host.replaceChildren();
  else if (newest && !host.firstElementChild) draw(host);
}

/** Show a picture: as an image, in which nothing runs, whoever drew it; `clicked` is told where, as shares of its width and height. */
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
