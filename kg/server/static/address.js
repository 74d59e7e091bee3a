// Addresses of the server that the page came from, at whatever path a reverse proxy publishes it.

/** The path before all addresses of the server: that of this file without `/static/address.js`; often empty. */
export const ROOT = new URL("..", import.meta.url).pathname.slice(0, -1);

/** Return the path of a page or endpoint, `/node?iri=...`, as this server has it. */
export function url(path) {
  return ROOT + path;
}
