// A link `/login#token=...` logs in. What stands behind the # is never sent, so no log of a server or proxy has it.

const given = new URLSearchParams(location.hash.slice(1)).get("token");
if (given) {
  history.replaceState(null, "", location.pathname + location.search);
  document.getElementById("token").value = given;
  document.getElementById("login").requestSubmit();
}
